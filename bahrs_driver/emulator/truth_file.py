# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The truth, one JSON object a line, for whoever wants to know how far off they are."""

import json
from typing import Protocol

from bahrs_driver.emulator.emulation import Sent
from bahrs_driver.emulator.host_time import HostTime
from bahrs_driver.units import NS_PER_S

_FLUSH_PERIOD = 0.5         # s, after which others can read what was written


class TextOutput(Protocol):
    """What the lines are written to."""

    def write(self, text: str) -> object:
        """Append a text."""

    def flush(self) -> object:
        """Let others see what was written."""


class TruthFile:
    """
    Writes a line for each frame that the device sent, and for each thing done to it.

        {"message": "inertial", "host_monotonic_ns": ..., "host_unix_ns": ...,
         "device_time_us": 600000, "specific_force": [0.0, 0.0, -9.80665],
         "angular_rate": [0.0, 0.0, 0.0], "sequence": 0, "wire": "intact"}

    The host's times are those of the sample (of a sync pulse, of the pulse), not of its arrival.
    The values are without noise and quantisation. `wire` is what became of the frame on its way:
    intact, damaged, dropped, overrun, unplugged.
    """

    def __init__(self, file: TextOutput) -> None:
        self._file = file
        self._flush_due = 0.0

    def sent(self, sent: Sent, zero: HostTime) -> None:
        """Write what was so when the device measured what a frame tells."""
        emission = sent.emission
        self._write({'message': emission.name}, emission.time, zero,
                    {**emission.truth, 'wire': sent.wire})

    def event(self, text: str, time: float, zero: HostTime) -> None:
        """Write what somebody did."""
        self._write({'event': text}, time, zero, {})

    def _write(self, head: dict[str, object], time: float, zero: HostTime,
               values: dict[str, object]) -> None:
        since = round(time * NS_PER_S)
        self._file.write(json.dumps({
            **head, 'host_monotonic_ns': zero.monotonic_ns + since,
            'host_unix_ns': zero.unix_ns + since, **values}) + '\n')
        if time >= self._flush_due:
            self._flush_due = time + _FLUSH_PERIOD
            self._file.flush()
