# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Synchronisation pulses, in literal figures."""

from bahrs_driver.emulator.bahrs.pulses import Pulses
import pytest


def taken(pulses, until, step=0.005):
    """Return the pulses that a device takes which looks every 5 ms."""
    times = (round(index * step, 6) for index in range(1, round(until / step) + 1))
    return [pulse for pulse in map(pulses.latest, times) if pulse is not None]


def test_pulses_come_at_whole_periods():
    """Of a time whose zero may be elsewhere."""
    pulses = Pulses(1.0, origin=-0.3)
    pulses.skip_until(0.0)
    assert taken(pulses, 4.0) == pytest.approx([0.7, 1.7, 2.7, 3.7])


def test_no_rate_means_no_pulse():
    """And one that is set later does not bring those that would have been."""
    pulses = Pulses(0.0)
    assert taken(pulses, 3.0) == []
    pulses.rate = 10.0
    assert pulses.latest(3.05) is None
    assert pulses.latest(3.1) == pytest.approx(3.1)


def test_the_device_ignores_pulses_that_come_too_soon():
    """Of pulses 50 ms apart it takes every second one, of 100 ms apart each."""
    fast, slow = Pulses(20.0), Pulses(10.0)
    fast.skip_until(0.0)
    slow.skip_until(0.0)
    assert taken(fast, 2.0) == pytest.approx([0.05 + 0.1 * index for index in range(20)])
    assert len(taken(slow, 2.0)) == 20


def test_of_several_pulses_the_latest_is_told():
    """Where the device was busy for a while."""
    pulses = Pulses(1.0)
    pulses.skip_until(0.5)
    assert pulses.latest(3.2) == 3.0
    assert pulses.latest(3.3) is None
