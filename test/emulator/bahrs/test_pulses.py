# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of sync pulses, with literal values."""

from bahrs_driver.emulator.bahrs.pulses import Pulses
import pytest


def taken(pulses, until, step=0.005):
    """Return the pulses that a device accepts when it looks every 5 ms."""
    times = (round(index * step, 6) for index in range(1, round(until / step) + 1))
    return [pulse for pulse in map(pulses.take_latest, times) if pulse is not None]


def test_pulses_come_at_whole_periods():
    """The period starts at any origin."""
    pulses = Pulses(1.0, origin=-0.3)
    pulses.skip_until(0.0)
    assert taken(pulses, 4.0) == pytest.approx([0.7, 1.7, 2.7, 3.7])


def test_no_rate_means_no_pulse():
    """A rate that is set later causes no earlier pulses."""
    pulses = Pulses(0.0)
    assert taken(pulses, 3.0) == []
    pulses.rate = 10.0
    assert pulses.take_latest(3.05) is None
    assert pulses.take_latest(3.1) == pytest.approx(3.1)


def test_pulses_in_quick_succession_are_ignored():
    """Of pulses at 50 ms it accepts every second one, at 100 ms every one."""
    fast, slow = Pulses(20.0), Pulses(10.0)
    fast.skip_until(0.0)
    slow.skip_until(0.0)
    assert taken(fast, 2.0) == pytest.approx([0.05 + 0.1 * index for index in range(20)])
    assert len(taken(slow, 2.0)) == 20


def test_of_several_pulses_the_latest_is_reported():
    """Earlier pulses are lost if the device was busy."""
    pulses = Pulses(1.0)
    pulses.skip_until(0.5)
    assert pulses.take_latest(3.2) == 3.0
    assert pulses.take_latest(3.3) is None
