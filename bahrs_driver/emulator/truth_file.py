# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write ground truth, one JSON object per line."""

import json
from typing import Protocol

from bahrs_driver.emulator.emulation import SentFrame
from bahrs_driver.emulator.host_time import HostTime
from bahrs_driver.units import NS_PER_S

_FLUSH_PERIOD = 0.5         # s, after which others can read the lines


class TextOutput(Protocol):
    """A file for the lines."""

    def write(self, text: str) -> object:
        """Append a text."""

    def flush(self) -> object:
        """Make the lines visible to others."""


class TruthFile:
    """
    Writes a line for each frame that the device sends, and for each command.

        {"message": "inertial", "host_monotonic_ns": ..., "host_unix_ns": ...,
         "device_time_us": 600000, "specific_force": [0.0, 0.0, -9.80665],
         "angular_rate": [0.0, 0.0, 0.0], "sequence": 0, "wire": "intact"}

    Host times are those of the sample (or of the sync pulse), not of its arrival. Values are
    without noise and quantisation. `wire` is the fate of the frame on the line: intact, damaged,
    dropped, overrun, unplugged.
    """

    def __init__(self, file: TextOutput) -> None:
        self._file = file
        self._flush_due = 0.0

    def sent(self, sent: SentFrame, zero: HostTime) -> None:
        """Write the true values of a frame."""
        emission = sent.emission
        self._write({'message': emission.name}, emission.time, zero,
                    {**emission.truth, 'wire': sent.wire})

    def event(self, text: str, time: float, zero: HostTime) -> None:
        """Write a command."""
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
