# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of when a device stood still."""

from bahrs_driver.report.rest import longest_rest
import numpy as np
import pytest

SECONDS = 0.005 * np.arange(20_000)         # 100 s


def still():
    """Return force and rate of a device at rest."""
    random = np.random.default_rng(3)
    force = np.array([0.0, 0.0, -9.8]) + random.normal(0.0, 0.01, (20_000, 3))
    return force, random.normal(0.0, 0.0005, (20_000, 3))


def rest_of(force, rate, seconds=SECONDS):
    """Return from when to when it stood still for longest."""
    rest = longest_rest(seconds, force, rate)
    return seconds[rest.begin], seconds[rest.end - 1]


def test_at_rest_all_the_time():
    """From the first sample to the last."""
    assert rest_of(*still()) == pytest.approx((0.0, SECONDS[-1]))


def test_a_turn_and_a_push():
    """Both end a rest; the longest of the three is returned."""
    force, rate = still()
    rate[6_000:6_200, 2] += 0.3
    force[8_000:8_400, 0] += 2.0
    begin, end = rest_of(force, rate)
    assert begin == pytest.approx(42.0, abs=2.0) and end == SECONDS[-1]


def test_a_new_position():
    """Standing otherwise than before is another rest."""
    force, rate = still()
    force[6_000:] = force[6_000:] @ np.array([[1, 0, 0], [0, 0.98, 0.2], [0, -0.2, 0.98]])
    assert rest_of(force, rate)[0] >= 30.0


def test_a_gap_ends_a_rest():
    """For noise must be evenly spaced."""
    force, rate = still()
    seconds = np.where(np.arange(20_000) >= 12_000, SECONDS + 0.05, SECONDS)
    begin, end = rest_of(force, rate, seconds)
    assert begin == 0.0 and end < 60.1


def test_always_in_motion():
    """There is no rest."""
    force, rate = still()
    rest = longest_rest(SECONDS, force, rate + 0.1)
    assert rest.begin == rest.end


def test_what_is_not_available_is_no_rest():
    """Nobody knows."""
    force, rate = still()
    rest = longest_rest(SECONDS, np.full_like(force, np.nan), rate)
    assert rest.begin == rest.end
