# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the stamps of messages that the system buffered while the driver did not run."""

from clock_simulation import Case, ORIGIN, Read, Simulation
import pytest
from support.simulated import simulated

BEGIN = 12.0            # s
TERMINAL, SOCKET = 4096, 10 ** 6        # bytes that wait in the system


class Stalled(Simulation):
    """A simulation with a pause, after which one read returns all buffered bytes."""

    def __init__(self, case, seed, stall, buffer):
        """Stall for some seconds, with a buffer of some bytes."""
        super().__init__(case, seed)
        self._begin, self._end = (ORIGIN + round(s * 1e9) for s in (BEGIN, BEGIN + stall))
        self._buffer = buffer

    def reads(self):
        """Yield the reads in order."""
        before, missed, waiting = 0, 0, []
        for now, received, messages in super().reads():
            if now.raw_ns < self._begin:
                before = received
            elif now.raw_ns < self._end:
                missed = max(0, received - before - self._buffer)
                waiting += [item for item in messages
                            if item[1].offset + len(item[1].data) <= before + self._buffer]
                continue
            yield Read(now, received - missed, waiting + [
                (message, self._moved(frame, missed)) for message, frame in messages
                if now.raw_ns < self._begin or frame.offset >= before + missed + self._buffer
                or not missed])
            waiting = []

    def _moved(self, frame, missed):
        moved = frame._replace(offset=frame.offset - missed)
        self.truths[moved.offset] = self.truths[frame.offset]
        return moved


@pytest.mark.parametrize('adapter', [0.016, 'plain'])
@pytest.mark.parametrize('stall, buffer', [
    (0.9, TERMINAL), (1.5, TERMINAL), (3.1, TERMINAL), (9.0, TERMINAL), (3.1, SOCKET)])
def test_stamps_after_a_pause_of_the_driver(stall, buffer, adapter):
    """No stamp jumps, and no restart of the device is reported."""
    outcome = simulated(Case(16.0 + stall, adapter, drift_ppm=80.0), simulation=lambda case, seed:
                        Stalled(case, seed, stall, buffer))
    assert max(map(abs, outcome.within(3))) < 500
    held = min(stall, 3600 / 11520 if buffer == TERMINAL else stall)
    assert len(outcome.within(BEGIN + stall - 0.1, BEGIN + stall + 0.5)) > 200 * held
    assert outcome.notices == [] and outcome.state.epochs == 1
    assert outcome.backward == outcome.future == 0
