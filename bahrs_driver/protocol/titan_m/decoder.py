# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decoder of the answers of a Titan-M, polled by the driver or by another host."""

from collections.abc import Collection
from typing import Any

from bahrs_driver.protocol.decoder import Decoder, ItemT
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.frames import Answer, answer_of
from bahrs_driver.protocol.titan_m.messages import TitanAnswer
from bahrs_driver.protocol.titan_m.poller import Poller


class TitanDecoder(Decoder):
    """
    Matches answers to the requests of a poller, and decodes their payloads.

    The clock stamps an answer by the time of its request, so the payload is decoded afterwards.
    """

    def __init__(self, payloads: PayloadDecoder[Any], poller: Poller | None = None) -> None:
        self._payloads = payloads
        self._poller = poller

    def open(self, byte_time_ns: int) -> None:      # noqa: A003, the usual name
        """Begin to poll."""
        if self._poller:
            self._poller.start(byte_time_ns)

    def close(self) -> None:
        """Stop polling, and forget the byte order: another device may be on the line next."""
        self._payloads.reset()
        if self._poller:
            self._poller.stop()

    def expected(self) -> Collection[type[TitanAnswer]] | None:
        """Return the kinds of answers that are outstanding; None without a poller."""
        return self._poller.expected() if self._poller else None

    def decode(self, frame: Frame, now: int) -> Answer:
        """Return the answer in a frame, matched to its request."""
        answer = answer_of(frame)
        return self._poller.match(answer, now) if self._poller else answer

    def resolve(self, items: list[ItemT]) -> list[ItemT]:
        """Decode payloads; hold answers until their byte order is known."""
        return [resolved for item in items for resolved in self._payloads.resolve(item)]
