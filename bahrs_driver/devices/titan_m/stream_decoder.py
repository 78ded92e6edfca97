# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode the answers of a Titan-M into typed messages."""

import argparse
from collections.abc import Sequence

from bahrs_driver.clock import Clock
from bahrs_driver.devices.stream_decoder import StreamDecoder
from bahrs_driver.devices.titan_m.settings import TitanMSettings
from bahrs_driver.pipeline import Pipeline, Stamped
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.decoder import TitanDecoder
from bahrs_driver.protocol.titan_m.frames import AnswerFormat, message_id
from bahrs_driver.protocol.titan_m.messages import ANSWERS, Gps, LAST_ZONE

# Columns of a GPS answer that have no value without a position.
OF_A_POSITION = ('easting', 'northing', 'altitude', 'velocity_ned_north', 'velocity_ned_east',
                 'velocity_ned_down', 'heading_deg', 'speed', 'ground_speed')
MOST_HELD = 100_000         # answers that wait for their byte order; a stream may never reveal it


class _OneStreamDecoder(TitanDecoder):
    """A decoder whose byte order is still known after the end of its stream."""

    def close(self) -> None:
        """Do nothing: no other device follows."""


class TitanStreamDecoder(StreamDecoder[TitanMSettings]):
    """Decodes the answers of a Titan-M. The protocol has no version."""

    head = ('version', 'message_id')
    kinds = ANSWERS

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Add the options that describe a Titan-M."""
        parser.add_argument('--payload-order', choices=('auto', 'little', 'big'), default='auto',
                            help='titan_m: byte order of payloads (default: %(default)s)')
        parser.add_argument('--checksum-order', choices=('auto', 'little', 'big'), default='auto',
                            help='titan_m: byte order of checksums (default: %(default)s)')

    @classmethod
    def settings(cls, options: argparse.Namespace) -> TitanMSettings:
        """Return the settings that the options stand for."""
        return TitanMSettings(payload_order=options.payload_order,
                              checksum_order=options.checksum_order)

    def __init__(self, settings: TitanMSettings, clock: Clock | None = None) -> None:
        self._format = AnswerFormat(settings.checksum_order)
        self._payloads = PayloadDecoder[Stamped](settings.payload_order, MOST_HELD)
        self.pipeline = Pipeline(Framer(self._format), _OneStreamDecoder(self._payloads), clock)

    def head_values(self, frame: Frame) -> dict[str, object]:
        """Return the message id of the answer."""
        return {'version': None, 'message_id': message_id(frame)}

    def unavailable(self, message: Message) -> Sequence[str]:
        """Return the columns of a GPS answer that have no value without a position."""
        no_position = isinstance(message, Gps) and not 1 <= message.zone <= LAST_ZONE
        return OF_A_POSITION if no_position else ()

    def detected(self) -> list[tuple[str, object]]:
        """Return detected properties of the protocol, by name."""
        return [('payload byte order', self._payloads.order),
                ('checksum byte order', self._format.checksum_order.seen)]

    def complaint(self) -> str:
        """Return how many answers have an unknown byte order."""
        count = self._payloads.held + self._payloads.dropped
        if not count:
            return ''
        return (f'{count} answers are not decoded, because their byte order is unknown: add '
                '--payload-order little or --payload-order big')
