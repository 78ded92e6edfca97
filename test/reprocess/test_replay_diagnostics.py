# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the diagnostics of a recorded flight."""

import functools
import random

from hypothesis import given, settings, strategies as st
import pytest
from support.conversions import converted, flight, ORIGIN, Pieces, S

SECONDS = 12.0
QUIET = 1.2             # s without data, after which no task may be OK
OK = b'\0'


@functools.cache
def whole_flight():
    """Return the chunks of a flight."""
    return flight(SECONDS)[0]


def reports(chunks):
    """Return the time of each report, its number of tasks, and the tasks that are OK."""
    kept, _ = converted(Pieces(chunks, None))
    return [(time, len(array.status), {status.name for status in array.status
                                       if status.level == OK})
            for time, array in kept.messages['/diagnostics']]


def noise(chunk):
    """Return a chunk with as many random bytes."""
    return chunk._replace(data=random.Random(chunk.ros_ns).randbytes(len(chunk.data)))


@pytest.mark.slow
@settings(max_examples=20)
@given(begin=st.floats(1.5, 6.0), seconds=st.floats(0.5, 5.0), junk=st.booleans(),
       reopened=st.booleans())
def test_no_task_is_ok_without_frames(begin, seconds, junk, reopened):
    """There are no bytes, or bytes without frames; then the connection may be a new one."""
    first, last = ORIGIN + round(begin * S), ORIGIN + round((begin + seconds) * S)
    chunks = whole_flight()
    quiet = [chunk for chunk in chunks if first < chunk.ros_ns < last]
    found = reports([
        *(chunk for chunk in chunks if chunk.ros_ns <= first), *map(noise, quiet if junk else []),
        *(chunk._replace(connection_id=1 + reopened) for chunk in chunks if chunk.ros_ns >= last)])
    while_quiet = [(count, ok) for time, count, ok in found
                   if first + QUIET * S < time < last]
    assert len(while_quiet) >= int(seconds - QUIET)
    for count, ok in while_quiet:
        assert len(ok) < count if junk else not ok
    before = [len(ok) for time, _, ok in found if first - S < time <= first]
    assert before and max(before) == 6


def test_all_tasks_are_ok_in_a_good_flight():
    """They are OK once the rates are known."""
    assert {len(ok) for time, _, ok in reports(whole_flight())
            if 4 * S < time - ORIGIN < (SECONDS - 0.5) * S} == {6}
