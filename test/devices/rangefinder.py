# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A device in one module: a rangefinder that sends the height of the vehicle 20 times a second.

    52 46 | sequence u8 | range f32 [m] | checksum u8           (little-endian)

docs/adding-a-device.md explains it. As a script it adds the device to the registry and runs a
command: `python rangefinder.py bahrs decode --sensor rangefinder ranges.bin`.
"""

from dataclasses import dataclass
import struct
import sys
from typing import ClassVar

from bahrs_driver.clock import ArrivalClock
from bahrs_driver.convert.values import Float64
from bahrs_driver.devices.parts import Converter, Parts
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import DeviceSpec
from bahrs_driver.devices.stream_decoder import StreamDecoder
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.stream_health import StreamHealth
from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.message import Message

FRAME = struct.Struct('<2sBfB')
RATE = 20.0         # Hz


@dataclass(frozen=True)
class Range(Message):
    """The distance to the ground in m."""

    NAME: ClassVar[str] = 'range'
    sequence: int
    range: float            # noqa: A003, the name of the topic, too


class RangeFormat:
    """The frame format, for the framer."""

    marker = b'RF'
    header_size = 2

    def sizes(self, _header, _expected):
        """Return the possible sizes of a frame."""
        return (FRAME.size,)

    def passing_checksum(self, frame, _expected):
        """Return the name of the checksum if it matches."""
        return 'sum' if sum(frame[:-1]) % 256 == frame[-1] else None

    def name_unknown(self, _frame):
        """Return None: there is one type of frame."""


class RangeDecoder(Decoder):
    """Decodes frames."""

    def decode(self, frame, _now=0):
        """Return the message of an intact frame."""
        return Range(*FRAME.unpack(frame.data)[1:3])


class RangeStreamDecoder(StreamDecoder):
    """Decodes a stream for `bahrs decode`."""

    kinds = (Range,)

    def __init__(self, _settings, clock=None):
        self.pipeline = Pipeline(Framer(RangeFormat()), RangeDecoder(), clock)


class RangeConverter(Converter):
    """Converts messages to values of ROS messages."""

    def convert(self, message, _stamp_ns):
        """Convert a message to values, each with its topic."""
        yield 'range', Float64(message.range)


class EmulatedRangefinder(EmulatedDevice):
    """Measures the height without errors."""

    next_time = 0.0

    def __init__(self, motion):
        self._motion = motion
        self._count = 0

    def step(self):
        """Advance to next_time and return the frames that are sent then."""
        time, height = self.next_time, self._motion.at(self.next_time).pressure_height
        body = FRAME.pack(b'RF', self._count % 256, height, 0)[:-1]
        self._count += 1
        self.next_time = self._count / RATE
        frame = body + bytes([sum(body) % 256])
        return [Emission(time, frame, Range.NAME, {'range': height}, time)]

    def power_cycle(self, _time):
        """Do nothing: the device starts at once."""


class RangefinderEmulation:
    """Makes emulated rangefinders."""

    def add_arguments(self, _parser):
        """Add no options."""

    def make_device(self, _options, motion, _noise, _zero):
        """Return an emulated device."""
        return EmulatedRangefinder(motion)


class RangefinderSpec(DeviceSpec[CommonSettings]):
    """The rangefinder."""

    name = 'rangefinder'
    label = 'rangefinder'
    settings = CommonSettings
    stream_decoder = RangeStreamDecoder

    def frame_format(self):
        """Return the frame format with default settings."""
        return RangeFormat()

    def emulation(self):
        """Return what emulates the device."""
        return RangefinderEmulation()

    def topics(self):
        """Return the class of the values of each topic."""
        return {'range': Float64}

    def parts(self, settings):
        """Return new parts for one stream."""
        timeout = settings.diagnostics.silence_timeout
        rates = RatesTask({Range.NAME: RATE}, settings.diagnostics.rate_tolerance, timeout)
        return Parts(Framer(RangeFormat()), RangeDecoder(), ArrivalClock(), RangeConverter(),
                     StreamHealth(rates), timeout, 'is the rangefinder powered?')


DEVICES[RangefinderSpec.name] = RangefinderSpec()

if __name__ == '__main__':
    command = sys.argv.pop(1)
    if command == 'bahrs':
        from bahrs_driver.cli.main import main
    else:
        from bahrs_driver.node.main import main
    sys.exit(main())
