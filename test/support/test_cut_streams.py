# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test streams that begin and end at any byte: stamps increase and keep the period."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from bahrs_driver.clock import SampleClock
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.virtual_serial.pacing import pace
from hypothesis import example, given, settings, strategies as st
import pytest
from support.cut_streams import (
    ADAPTERS, check_promises, converted, emulated, live, Stamps, Stream, through, worst_period,
)
from support.shared_files import shared_file

# Of a period. In the first seconds stamps follow the estimate by 10 % at most, and at once where
# the bytes of the second read prove that all samples of the first one were late.
SETTLING = 0.3
SETTLED = 0.03
Way = Callable[[Stream, SampleClock], Stamps]
Adapter = str | float
ways: st.SearchStrategy[Way] = st.sampled_from([live, converted])
ends = st.floats(0, 1)
BAHRS = DEVICES['bahrs']


@lru_cache(maxsize=8)
def recorded(adapter: Adapter) -> Stream:
    """Return the first half minute of the recording, after the pause at its beginning."""
    data = shared_file('data/bahrs_recording_v2.bin').read_bytes()[644:200_000]
    pieces = list(pace([data], Framer(BAHRS.frame_format()), BAHRS.frame_period))
    truth: dict[int, tuple[int, int]] = {}
    offset = 0
    for index, (_, piece) in enumerate(pieces):         # an inertial message begins each
        truth[offset] = 0, index * 5_000_000
        if index % 2 == 0:
            place = piece.index(b'NE\x02\x00\x02')
            truth[offset + place] = truth[offset]
        offset += len(piece)
    return Stream(through(pieces, adapter), truth)


@settings(max_examples=60)
@given(adapter=st.sampled_from(ADAPTERS), begin=st.integers(0, 190_000),
       length=st.integers(0, 9_000), way=ways)
@example(adapter='none', begin=24, length=9_000, way=live)
def test_the_recording(adapter: Adapter, begin: int, length: int, way: Way) -> None:
    """Even if it begins with a navigation message, or has no time message."""
    stream = recorded(adapter).cut(begin, begin + length)
    assert worst_period(check_promises(way(stream, SampleClock(ROLES)), stream.truth)) < SETTLING


@pytest.mark.slow
@settings(max_examples=80)
@given(adapter=st.sampled_from(ADAPTERS), version=st.integers(1, 3),
       loss=st.sampled_from([0.0, 0.01, 0.05]), damage=st.sampled_from([0.0, 0.0003]),
       seed=st.integers(0, 99),
       restarts=st.lists(st.floats(0.7, 4.0), max_size=2).map(sorted),
       begin=ends, end=ends, way=ways)
def test_emulated_devices(begin: float, end: float, way: Way, **what: Any) -> None:
    """Of every protocol version, with losses and restarts."""
    stream = emulated(5.0, **what).cut(begin, end)
    assert worst_period(check_promises(way(stream, SampleClock(ROLES)), stream.truth)) < SETTLING


@settings(max_examples=20)
@given(adapter=st.sampled_from(ADAPTERS), begin=ends, end=ends, way=ways)
def test_a_device_whose_time_messages_name_their_own_sample(
        adapter: Adapter, begin: float, end: float, way: Way) -> None:
    """As the document can be read."""
    stream = emulated(5.0, adapter, time_label='same', restarts=(2.0,)).cut(begin, end)
    assert worst_period(check_promises(way(stream, SampleClock(ROLES)), stream.truth)) < SETTLING


@pytest.mark.parametrize('adapter', ADAPTERS)
def test_the_last_samples_are_as_even_as_the_others(adapter: Adapter) -> None:
    """A stamp does not depend on the end of the stream."""
    stream = emulated(8.0, adapter).cut(0.3, 1.0)
    for way in (live, converted):
        samples = check_promises(way(stream, SampleClock(ROLES)), stream.truth)
        assert worst_period(samples[-200:]) < SETTLED
