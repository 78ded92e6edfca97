# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the notices on the topic `integrity`, and of their stamps."""

from itertools import pairwise

from bahrs_driver.convert.bahrs.integrity_notice import IntegrityNotice, SET_BACK
from bahrs_driver.protocol.integrity import Integrity
from hypothesis import given, strategies as st

SECOND = 1_000_000_000
SAFE, RISK = Integrity.SAFE, Integrity.INTEGRITY_RISK
START = 1_700_000_000 * SECOND


def stamp(notice):
    """Return the stamp of a notice in ns."""
    return notice.stamp_ns


def states(notice):
    """Return the integrity of each signal in a notice."""
    return [status.message for status in notice.status]


def test_a_change_has_the_stamp_of_its_sample():
    """Without a change there is no notice."""
    notices = IntegrityNotice(['roll', 'pitch'])
    first = notices.update(('roll', 'pitch'), (SAFE, SAFE), START, 'imu')
    assert (stamp(first), states(first)) == (START, ['safe', 'safe'])
    assert notices.update(('roll', 'pitch'), (SAFE, SAFE), START + 10, 'imu') is None
    change = notices.update(('roll', 'pitch'), (SAFE, RISK), START + 20, 'imu')
    assert (stamp(change), states(change)) == (START + 20, ['safe', 'integrity_risk'])


def test_integrity_is_unknown_from_the_last_sample_of_a_stream():
    """The notice may be late; the next sample has a later stamp."""
    notices = IntegrityNotice(['roll'])
    notices.update(('roll',), (SAFE,), START, 'imu')
    notices.update(('roll',), (SAFE,), START + 50, 'imu')
    end = notices.forget(START + 2 * SECOND, 'imu')
    assert (stamp(end), states(end)) == (START + 51, ['not_heard'])
    assert notices.forget(START + 3 * SECOND, 'imu') is None
    assert stamp(notices.update(('roll',), (SAFE,), START + 60, 'imu')) == START + 60


def test_the_first_notice_may_be_unknown():
    """It is published once, for subscribers that join late."""
    notices = IntegrityNotice(['roll'])
    assert stamp(notices.forget(START, 'imu')) == START
    assert notices.forget(START + 5, 'imu') is None
    # What the system held back before the port was open.
    assert stamp(notices.update(('roll',), (SAFE,), START - SECOND // 2, 'imu')) == START


def test_stamps_follow_a_clock_that_was_set_back():
    """Otherwise they would be in the future for an hour."""
    notices = IntegrityNotice(['roll'])
    notices.update(('roll',), (SAFE,), START, 'imu')
    back = START - 3600 * SECOND
    assert stamp(notices.update(('roll',), (RISK,), back, 'imu')) == back


@given(st.lists(st.tuples(
    st.sampled_from(['force', 'attitude', 'forget']), st.sampled_from(Integrity),
    st.integers(-SET_BACK // 4, SECOND))))
def test_stamps_never_decrease(events):
    """Samples are out of order by up to 0.25 s, and there are pauses and lost links."""
    notices, now, published = IntegrityNotice(['force', 'attitude']), START, []
    for kind, state, step in events:
        now = max(now + step, START - SET_BACK // 4)
        if kind == 'forget':
            notice = notices.forget(now, 'imu')
        else:
            notice = notices.update((kind,), (state,), now, 'imu')
        if notice:
            published.append(notice)
    assert all(stamp(a) <= stamp(b) for a, b in pairwise(published))
    assert all(states(a) != states(b) for a, b in pairwise(published))
