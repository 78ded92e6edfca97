# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test which parts of a flight count as rest."""

from types import SimpleNamespace

from bahrs_driver.emulator.motion import SmoothValue, true_values
from bahrs_driver.report.rest import find_rest
import pytest
from support.emulated import make_device, make_emulation
from support.recorded import recorded

LEVEL, STILL = SmoothValue(0.0), SmoothValue(1.0)


@pytest.mark.slow
@pytest.mark.parametrize(('climb', 'rest'), [(12.0, 0.0), (-12.0, 0.0), (0.0, 4.4)])
def test_steady_climb_is_no_rest(climb, rest):
    """Nor is a descent, although force and rate are as steady as on the ground."""
    motion = SimpleNamespace(at=lambda time: true_values(
        SmoothValue(60.0), SmoothValue(climb), LEVEL, STILL, 3000.0 + climb * time))
    found = find_rest(recorded(make_emulation(make_device(motion)), 5.0, timed=False))
    assert found.seconds == pytest.approx(rest, abs=0.2)
