# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write ground truth, one JSON object per line."""

import json
from typing import Protocol

from bahrs_driver.emulator.emulation import SentFrame
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.units import NS_PER_S

_FLUSH_PERIOD = 0.5         # s; other programs read the file while it grows


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

    def write_frame(self, frame: SentFrame, start_time: StartTime) -> None:
        """Write the true values of a frame."""
        emission = frame.emission
        self._write({'message': emission.name}, emission.time, start_time,
                    {**emission.truth, 'wire': frame.fate})

    def write_command(self, line: str, time: float, start_time: StartTime) -> None:
        """Write a command."""
        self._write({'event': line}, time, start_time, {})

    def _write(self, head: dict[str, object], time: float, start_time: StartTime,
               values: dict[str, object]) -> None:
        elapsed_ns = round(time * NS_PER_S)
        self._file.write(json.dumps({
            **head, 'host_monotonic_ns': start_time.monotonic_ns + elapsed_ns,
            'host_unix_ns': start_time.unix_ns + elapsed_ns, **values}) + '\n')
        if time >= self._flush_due:
            self._flush_due = time + _FLUSH_PERIOD
            self._file.flush()
