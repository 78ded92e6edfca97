# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How the bytes of each sensor are decoded, for the verbs that work on recordings."""

import argparse
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat, frame_version
from bahrs_driver.protocol.bahrs.messages import MESSAGES, TimeMessage
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.titan_m.byte_order import PayloadReader
from bahrs_driver.protocol.titan_m.frames import answer_of, AnswerFormat, message_id
from bahrs_driver.protocol.titan_m.messages import ANSWERS, Gps, LAST_ZONE
from bahrs_driver.reprocess.message_times import with_times


_OF_A_POSITION = ('easting', 'northing', 'altitude', 'velocity_ned_north', 'velocity_ned_east',
                  'velocity_ned_down', 'heading_deg', 'speed', 'ground_speed')


MOST_HELD = 100_000         # answers that wait for their byte order; a stream may never show it


class Decoder(Protocol):
    """Finds the messages of one kind of device in a stream of bytes."""

    framer: Framer

    @property
    def kinds(self) -> Sequence[type[Any]]:
        """Classes of the messages."""

    @property
    def head(self) -> Sequence[str]:
        """Names that about() has."""

    def messages(self, frames: Iterable[Frame]) -> Iterable[tuple[Frame, Any]]:
        """Return the messages that frames complete, in the order of the stream."""

    def timed(self, messages: Iterable[tuple[Frame, Any]]
              ) -> Iterable[tuple[Frame, Any, int | None]]:
        """Return the messages with the device time of each in us; None if it is not known."""

    def about(self, frame: Frame) -> dict[str, Any]:
        """Return what a frame says beside its message."""

    def unavailable(self, message: Any) -> Sequence[str]:
        """Return the values, by the name of their column, that a message has no number for."""

    def detected(self) -> list[tuple[str, object]]:
        """Return what was found out of the device's protocol, by name."""

    def complaint(self) -> str:
        """Return what could not be decoded and why, at the end; empty if there is nothing."""


class BahrsDecoder:
    """Finds the messages of a BAHRS."""

    kinds = MESSAGES
    head = ('version',)

    def __init__(self, options: argparse.Namespace) -> None:
        self._format = BahrsFormat(options.crc)
        self._codec = BahrsCodec(options.pressure_height)
        self.framer = Framer(self._format)

    def messages(self, frames: Iterable[Frame]) -> Iterable[tuple[Frame, Any]]:
        """Return the messages that frames complete, in the order of the stream."""
        return ((frame, self._codec.decode(frame)) for frame in frames)

    def timed(self, messages: Iterable[tuple[Frame, Any]]
              ) -> Iterable[tuple[Frame, Any, int | None]]:
        """Return the messages with the device time of each in us; None if it is not known."""
        return with_times(messages)

    def about(self, frame: Frame) -> dict[str, Any]:
        """Return the version of the protocol."""
        return {'version': frame_version(frame.data)}

    def unavailable(self, message: Any) -> Sequence[str]:
        """Return the signals that are not available, and what a time message does not name."""
        if message.SIGNALS:
            return [name for name, integrity in zip(message.SIGNALS, message.health)
                    if not integrity.available]
        if isinstance(message, TimeMessage) and not message.valid:
            return ('reference_sequence',)
        return ()

    def detected(self) -> list[tuple[str, object]]:
        """Return what was found out of the device's protocol, by name."""
        return [('protocol version', self._format.version_seen),
                ('CRC order', self._format.order_seen)]

    def complaint(self) -> str:
        """Return nothing: all that is intact is decoded."""
        return ''


class TitanDecoder:
    """Finds the answers of a Titan-M; its protocol has no version."""

    kinds = ANSWERS
    head = ('version', 'message_id')

    def __init__(self, options: argparse.Namespace) -> None:
        self._format = AnswerFormat(options.checksum_order)
        self._reader = PayloadReader[Frame](options.payload_order, MOST_HELD)
        self.framer = Framer(self._format)

    def messages(self, frames: Iterable[Frame]) -> Iterable[tuple[Frame, Any]]:
        """Return the messages that can be read by now, in the order of the stream."""
        for frame in frames:
            answer = answer_of(frame)
            for message, found in self._reader.read(answer.kind, answer.payload, frame):
                yield found, message

    def timed(self, messages: Iterable[tuple[Frame, Any]]
              ) -> Iterable[tuple[Frame, Any, int | None]]:
        """Return the messages without a time: answers say none but that of the GPS."""
        return ((frame, message, None) for frame, message in messages)

    def about(self, frame: Frame) -> dict[str, Any]:
        """Return no version, and the id that the answer came with."""
        return {'version': None, 'message_id': message_id(frame)}

    def unavailable(self, message: Any) -> Sequence[str]:
        """Return what a GPS receiver does not know without a position."""
        no_position = isinstance(message, Gps) and not 1 <= message.zone <= LAST_ZONE
        return _OF_A_POSITION if no_position else ()

    def detected(self) -> list[tuple[str, object]]:
        """Return what was found out of the device's protocol, by name."""
        return [('payload byte order', self._reader.order),
                ('checksum byte order', self._format.checksum_order.seen)]

    def complaint(self) -> str:
        """Return whether answers could not be read, as nothing tells their byte order."""
        count = self._reader.held + self._reader.given_up
        if not count:
            return ''
        return (f'{count} answers are not decoded, for nothing in them tells their '
                'byte order: say --payload-order little or --payload-order big')


DECODERS: dict[str, Callable[[argparse.Namespace], Decoder]] = {
    'bahrs': BahrsDecoder, 'titan_m': TitanDecoder}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the options that tell what is in a recording."""
    parser.add_argument('--sensor', choices=tuple(DECODERS), default='bahrs',
                        help='which device sent it (default: %(default)s)')
    parser.add_argument('--crc', choices=('auto', 'word', 'byte'), default='auto',
                        help='bahrs: order of the CRC (default: %(default)s)')
    parser.add_argument('--pressure-height', choices=('uint16', 'int16'), default='uint16',
                        help='bahrs: format of the pressure height (default: %(default)s)')
    parser.add_argument('--payload-order', choices=('auto', 'little', 'big'), default='auto',
                        help='titan_m: byte order of payloads (default: %(default)s)')
    parser.add_argument('--checksum-order', choices=('auto', 'little', 'big'), default='auto',
                        help='titan_m: byte order of checksums (default: %(default)s)')
