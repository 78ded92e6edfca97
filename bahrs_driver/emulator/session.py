# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""An emulation with its scenario, commands and ground truth."""

from collections import deque
from collections.abc import Iterable

from bahrs_driver.emulator.control import execute
from bahrs_driver.emulator.emulation import Emulation, SentFrame
from bahrs_driver.emulator.scenario import TimedCommand
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.emulator.truth_file import TruthFile


class EmulationSession:
    """Advances an emulation, executes commands and writes ground truth."""

    def __init__(self, emulation: Emulation, scenario: Iterable[TimedCommand] = (),
                 truth_file: TruthFile | None = None) -> None:
        self.emulation = emulation
        self._scenario = deque(scenario)
        self._truth_file = truth_file

    @property
    def next_time(self) -> float:
        """Time of the next event."""
        time = self.emulation.next_time
        return min(time, self._scenario[0].time) if self._scenario else time

    def advance(self, until: float, start_time: StartTime) -> None:
        """Advance to a time; ControlError if a command of the scenario is invalid."""
        while self._scenario and self._scenario[0].time <= until:
            time, line = self._scenario.popleft()
            self._record(self.emulation.advance(time), start_time)
            self.execute(line, time, start_time)
        self._record(self.emulation.advance(until), start_time)

    def execute(self, line: str, now: float, start_time: StartTime) -> None:
        """Execute a command; ControlError if it is invalid."""
        execute(line, self.emulation, now)
        if self._truth_file and line.strip():
            self._truth_file.write_command(line.strip(), now, start_time)

    def receive(self, data: bytes, now: float, start_time: StartTime) -> None:
        """Pass bytes of the host to the device."""
        self._record(self.emulation.receive(data, now), start_time)

    def _record(self, frames: Iterable[SentFrame], start_time: StartTime) -> None:
        for frame in frames:
            if self._truth_file:
                self._truth_file.write_frame(frame, start_time)
