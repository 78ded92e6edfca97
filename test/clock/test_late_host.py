# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the stamps on a host that is late from the start, until it catches up."""

from bahrs_driver.clock import Instant
from clock_simulation import Case, ORIGIN, Read, Simulation
import pytest
from support.simulated import simulated

ALL, BUFFER, FRAME = 10 ** 6, 4000, 28          # bytes per read of what waits
READ_DURATION = 100_000         # ns
ADAPTERS = [0.016, 0.001, 'packets', 'plain']


class LateStart(Simulation):
    """A simulation whose first reads are late and return all bytes that wait by then."""

    def __init__(self, case, seed, end, size):
        """Read nothing until a time in s, then so many bytes per read until none waits."""
        super().__init__(case, seed)
        self._end, self._size = ORIGIN + round(end * 1e9), size

    def reads(self):
        """Yield the reads in order."""
        waiting, received, time, done = [], 0, self._end, 0
        for read in super().reads():
            if read.now.raw_ns < self._end:
                waiting += read.messages
                received = read.received
                continue
            while done < received:
                done = min(received, done + self._size)
                ready = [item for item in waiting if item[1].offset + len(item[1].data) <= done]
                del waiting[:len(ready)]
                yield Read(Instant(time, self.case.ros(time)), done, ready)
                time += READ_DURATION
            time = max(time, read.now.raw_ns)
            yield read._replace(now=Instant(time, self.case.ros(time)))


class LateReads(Simulation):
    """A simulation whose reads are late by the same time until the host catches up."""

    def __init__(self, case, seed, end, delay):
        """Delay each read that is due before a time in s."""
        super().__init__(case, seed)
        self._end, self._delay = ORIGIN + round(end * 1e9), round(delay * 1e9)

    def reads(self):
        """Yield the reads in order."""
        time = 0
        for read in super().reads():
            due = read.now.raw_ns
            time = max(time + 1000, due + self._delay * (due < self._end))
            yield read._replace(now=Instant(time, self.case.ros(time)))


def check(outcome, end):
    """Check that no sample is dropped and that stamps are good soon after a time in s."""
    assert outcome.state.dropped == 0
    assert outcome.backward == outcome.future == 0
    assert max(map(abs, outcome.within(end + 0.4))) < 1000
    assert max(map(abs, outcome.within(end + 2))) < 500


@pytest.mark.parametrize('adapter', ADAPTERS)
@pytest.mark.parametrize('size', [ALL, BUFFER, FRAME])
@pytest.mark.parametrize('end', [0.8, 1.16, 1.3, 1.8, 4.6])
def test_a_late_first_read(end, size, adapter):
    """The device sends from 0.6 s on."""
    for loss in (0.0, 0.05):
        outcome = simulated(Case(end + 4, adapter, loss=loss), simulation=lambda case, seed:
                            LateStart(case, seed, end, size))
        check(outcome, end)


@pytest.mark.parametrize('adapter', ADAPTERS)
@pytest.mark.parametrize('delay', [0.005, 0.03, 0.2])
@pytest.mark.parametrize('end', [1.2, 2.0, 8.0])
def test_late_reads(end, delay, adapter):
    """Each sample that was sent while the host caught up is a little earlier than the last."""
    outcome = simulated(Case(end + 4, adapter), simulation=lambda case, seed:
                        LateReads(case, seed, end, delay))
    check(outcome, end + delay)


@pytest.mark.parametrize('adapter', ADAPTERS)
@pytest.mark.parametrize('end', [1.2, 2.0, 6.0])
def test_overload_from_the_start(end, adapter):
    """The delays of the reads are random."""
    check(simulated(Case(end + 4, adapter, overload=(0.0, end))), end + 0.2)
