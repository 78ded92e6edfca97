# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of emulated devices, with and without the times of reads."""

from collections.abc import Iterator
from pathlib import Path

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.emulator.emulation import Emulation
from bahrs_driver.report.gather import gather, Recording
from support.emulated import make_emulation

START = 1_700_000_000_000_000_000       # ns since the epoch
BYTE_NS = 86_806                        # at 115200 baud


class EmulatedCapture(Capture):
    """A capture of the output of an emulated device."""

    byte_ns = BYTE_NS
    timed = True

    def __init__(self, emulation: Emulation, seconds: float, every: float = 0.002,
                 timed: bool = True) -> None:
        """Capture a duration in seconds, with a read every `every` seconds."""
        super().__init__(Path('made_up.bin'), 0)
        self._emulation, self._seconds, self._every = emulation, seconds, every
        self._timed = timed

    def chunks(self) -> Iterator[Chunk]:
        """Yield the reads."""
        for index in range(round(self._seconds / self._every)):
            now = index * self._every
            list(self._emulation.advance(now))
            if data := self._emulation.take(now):
                yield Chunk(data, START + round(now * 1e9) if self._timed else None)


def gathered(capture: Capture) -> Recording:
    """Read a capture of a BAHRS with default settings."""
    recorded_format = DEVICES['bahrs'].recording_format(BahrsSettings())
    assert recorded_format
    return gather(capture, recorded_format)


def recorded(emulation: Emulation | None = None, seconds: float = 10.0, every: float = 0.002,
             timed: bool = True) -> Recording:
    """Return the recording of an emulated device."""
    return gathered(EmulatedCapture(emulation or make_emulation(), seconds, every, timed))
