# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the diagnostics of a flight: nothing is well while no data comes."""

import functools
import random

from hypothesis import given, settings, strategies as st
import pytest
from support.conversions import converted, flight, ORIGIN, Pieces, S

SECONDS = 12.0
QUIET = 1.2             # s without data, after which no task may be content
OK = b'\0'


@functools.cache
def whole_flight():
    """Return the chunks of a flight."""
    return flight(SECONDS)[0]


def reports(chunks):
    """Return when each report was made, how many tasks it has, and which are content."""
    kept, _ = converted(Pieces(chunks, None))
    return [(time, len(array.status), {status.name for status in array.status
                                       if status.level == OK})
            for time, array in kept.messages['/diagnostics']]


def noise(chunk):
    """Return as many bytes that are no frames, read at the same time."""
    return chunk._replace(data=random.Random(chunk.ros_ns).randbytes(len(chunk.data)))


@pytest.mark.slow
@settings(max_examples=20)
@given(begin=st.floats(1.5, 6.0), seconds=st.floats(0.5, 5.0), junk=st.booleans(),
       reopened=st.booleans())
def test_no_task_is_content_while_no_data_comes(begin, seconds, junk, reopened):
    """Whether bytes come that are no frames, or none; whether the port was opened again."""
    first, last = ORIGIN + round(begin * S), ORIGIN + round((begin + seconds) * S)
    chunks = whole_flight()
    quiet = [chunk for chunk in chunks if first < chunk.ros_ns < last]
    found = reports([
        *(chunk for chunk in chunks if chunk.ros_ns <= first), *map(noise, quiet if junk else []),
        *(chunk._replace(connection_id=1 + reopened) for chunk in chunks if chunk.ros_ns >= last)])
    while_quiet = [(count, content) for time, count, content in found
                   if first + QUIET * S < time < last]
    assert len(while_quiet) >= int(seconds - QUIET)
    for count, content in while_quiet:
        assert len(content) < count if junk else not content
    before = [len(content) for time, _, content in found if first - S < time <= first]
    assert before and max(before) == 6


def test_all_is_well_in_a_good_flight():
    """Once the rates are known, each task is content."""
    assert {len(content) for time, _, content in reports(whole_flight())
            if 4 * S < time - ORIGIN < (SECONDS - 0.5) * S} == {6}
