# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode the bytes of a BAHRS into typed messages."""

import argparse
from collections.abc import Sequence

from bahrs_driver.clock import Clock
from bahrs_driver.devices.bahrs.settings import BahrsSettings, PressureHeight
from bahrs_driver.devices.stream_decoder import StreamDecoder
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat, frame_version
from bahrs_driver.protocol.bahrs.messages import Inertial, MESSAGES, Navigation, TimeMessage
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.message import Message


class BahrsStreamDecoder(StreamDecoder[BahrsSettings]):
    """Decodes the stream of a BAHRS."""

    head = ('version',)
    kinds = MESSAGES

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Add the options that describe a BAHRS."""
        parser.add_argument('--crc', choices=('auto', 'word', 'byte'), default='auto',
                            help='bahrs: order of the CRC (default: %(default)s)')
        parser.add_argument('--pressure-height', choices=('uint16', 'int16'), default='uint16',
                            help='bahrs: format of the pressure height (default: %(default)s)')

    @classmethod
    def settings(cls, options: argparse.Namespace) -> BahrsSettings:
        """Return the settings that the options stand for."""
        return BahrsSettings(crc_order=options.crc,
                             pressure_height=PressureHeight(options.pressure_height))

    def __init__(self, settings: BahrsSettings, clock: Clock | None = None) -> None:
        self._format = BahrsFormat(settings.crc_order)
        self._codec = BahrsCodec(settings.pressure_height.format)
        self.pipeline = Pipeline(Framer(self._format), self._codec, clock)

    def head_values(self, frame: Frame) -> dict[str, object]:
        """Return the protocol version."""
        return {'version': frame_version(frame.data)}

    def unavailable(self, message: Message) -> Sequence[str]:
        """Return unavailable signals, and the reference of a time message without a time."""
        if isinstance(message, (Inertial, Navigation)):
            return [name for name, integrity in zip(message.SIGNALS, message.health)
                    if not integrity.available]
        if isinstance(message, TimeMessage) and not message.valid:
            return ('reference_sequence',)
        return ()

    def block_format(self) -> tuple[BahrsFormat, dict[bytes, str]]:
        """Return the format of frames that can be found in blocks, and message names by header."""
        return self._format, {header: layout.message.NAME
                              for header, layout in self._codec.layouts_by_header.items()}

    def detected(self) -> list[tuple[str, object]]:
        """Return detected properties of the protocol, by name."""
        return [('protocol version', self._format.version_seen),
                ('CRC order', self._format.order_seen)]
