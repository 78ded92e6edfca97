# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test in which interval a device was at rest."""

from types import SimpleNamespace

from bahrs_driver.emulator.motion import SmoothValue, true_values
from bahrs_driver.report.rest import find_rest, longest_rest
import numpy as np
import pytest
from support.emulated import make_device, make_emulation
from support.recorded import recorded

SECONDS = 0.005 * np.arange(20_000)         # 100 s
LEVEL, STILL = SmoothValue(0.0), SmoothValue(1.0)


def at_rest():
    """Return force and rate of a device at rest."""
    random = np.random.default_rng(3)
    force = np.array([0.0, 0.0, -9.8]) + random.normal(0.0, 0.01, (20_000, 3))
    return force, random.normal(0.0, 0.0005, (20_000, 3))


def rest_of(force, rate, seconds=SECONDS):
    """Return the times of the first and last sample of the longest rest."""
    rest = longest_rest(seconds, force, rate)
    return seconds[rest.begin], seconds[rest.end - 1]


def test_always_at_rest():
    """The rest is the whole recording."""
    assert rest_of(*at_rest()) == pytest.approx((0.0, SECONDS[-1]))


def test_turn_and_push():
    """Both end a rest; the longest of the three is returned."""
    force, rate = at_rest()
    rate[6_000:6_200, 2] += 0.3
    force[8_000:8_400, 0] += 2.0
    begin, end = rest_of(force, rate)
    assert begin == pytest.approx(42.0, abs=2.0) and end == SECONDS[-1]


def test_new_orientation():
    """A change of orientation begins another rest."""
    force, rate = at_rest()
    force[6_000:] = force[6_000:] @ np.array([[1, 0, 0], [0, 0.98, 0.2], [0, -0.2, 0.98]])
    assert rest_of(force, rate)[0] >= 30.0


def test_gap_ends_a_rest():
    """The samples of a rest are evenly spaced."""
    force, rate = at_rest()
    seconds = np.where(np.arange(20_000) >= 12_000, SECONDS + 0.05, SECONDS)
    begin, end = rest_of(force, rate, seconds)
    assert begin == 0.0 and end < 60.1


def test_always_in_motion():
    """A turning device is never at rest."""
    force, rate = at_rest()
    rest = longest_rest(SECONDS, force, rate + 0.1)
    assert rest.begin == rest.end


def test_unavailable_values_are_no_rest():
    """Without specific force there is no rest."""
    force, rate = at_rest()
    rest = longest_rest(SECONDS, np.full_like(force, np.nan), rate)
    assert rest.begin == rest.end


@pytest.mark.slow
@pytest.mark.parametrize(('climb', 'seconds'), [(12.0, 0.0), (-12.0, 0.0), (0.0, 4.4)])
def test_steady_climb_is_no_rest(climb, seconds):
    """Nor is a descent, although force and rate are as steady as on the ground."""
    motion = SimpleNamespace(at=lambda time: true_values(
        SmoothValue(60.0), SmoothValue(climb), LEVEL, STILL, 3000.0 + climb * time))
    rest = find_rest(recorded(make_emulation(make_device(motion)), 5.0, timed=False))
    assert rest.seconds == pytest.approx(seconds, abs=0.2)
