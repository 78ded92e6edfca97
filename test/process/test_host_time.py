# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of reading two clocks at once, on clocks that are interrupted and set at will."""

import time

from bahrs_driver.process import host_time
from bahrs_driver.process.host_time import ATTEMPTS, NARROW, paired_reading, SystemTime
from hypothesis import given, strategies as st
import pytest

MS = 1_000_000
OFFSET = 1_700_000_000_000_000_000


class Clocks:
    """A replacement for the module time whose readings take the given pauses, in ns."""

    CLOCK_MONOTONIC = time.CLOCK_MONOTONIC

    def __init__(self, pauses):
        """Pause after each reading for the given times, then not at all."""
        self._pauses = iter(pauses)
        self.monotonic = 10 ** 12
        self.offset = OFFSET

    def _read(self, offset):
        found = self.monotonic + offset
        self.monotonic += next(self._pauses, 0) + 100
        return found

    def clock_gettime_ns(self, _):
        """Read the monotonic clock."""
        return self._read(0)

    def time_ns(self):
        """Read the system time."""
        return self._read(self.offset)


@pytest.fixture
def clocks(monkeypatch):
    """Return a function that replaces the clocks of the system by ones with pauses."""
    def use(*pauses):
        made = Clocks(pauses)
        monkeypatch.setattr(host_time, 'time', made)
        return made
    return use


def test_one_reading_is_enough_if_nothing_interrupts(clocks):
    """The time is that of the call."""
    made = clocks()
    reading = paired_reading(time.CLOCK_MONOTONIC)
    assert reading.time == 10 ** 12 and abs(reading.offset - OFFSET) < 200
    assert made.monotonic - 10 ** 12 < 1000


@pytest.mark.parametrize('place', range(3))
def test_an_interruption_is_noticed_wherever_it_is(clocks, place):
    """They cost only another attempt."""
    clocks(*[0] * place, 5 * MS)
    assert abs(paired_reading(time.CLOCK_MONOTONIC).offset - OFFSET) < 200


@given(st.lists(st.integers(0, 5 * MS), min_size=2 * ATTEMPTS + 1, max_size=2 * ATTEMPTS + 1))
def test_the_true_offset_is_within_the_bounds(pauses):
    """For any interruptions."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(host_time, 'time', Clocks(pauses))
        _, least, most = paired_reading(time.CLOCK_MONOTONIC)
    widest = min(a + b for a, b in zip(pauses[::2], pauses[1::2])) + 200
    assert least <= OFFSET <= most and most - least <= max(widest, NARROW)


@given(st.lists(st.lists(st.integers(0, 5 * MS), min_size=2 * ATTEMPTS + 1), max_size=5))
def test_system_time_does_not_move_with_interruptions(readings):
    """Once it is known from a narrow bracket."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(host_time, 'time', Clocks([]))
        system = SystemTime()
        first = system.at(0)
        for pauses in readings:
            patch.setattr(host_time, 'time', Clocks(pauses))
            assert system.at(0) == first


def test_system_time_that_is_set_is_followed(clocks):
    """Also by as little as a millisecond."""
    made = clocks()
    system = SystemTime()
    first = system.at(0)
    made.offset -= MS
    assert abs(system.at(0) - first + MS) < 500
