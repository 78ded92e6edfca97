# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what the monitor keeps."""

from bahrs_driver.monitor import tally


def test_hours_without_a_look_take_no_memory(monkeypatch):
    """Only arrivals of the window are kept, though nobody asks for the rate."""
    now = [0.0]
    monkeypatch.setattr(tally.time, 'monotonic', lambda: now[0])
    tallied = tally.Tally()
    for _ in range(10_000):
        now[0] += 0.01
        tallied.add(b'message')
    assert len(tallied._arrivals) <= tally.RATE_WINDOW / 0.01 + 1
    assert tallied.count == 10_000
    assert abs(tallied.rate() - 100.0) < 1e-6


def test_two_messages_at_once_have_no_rate(monkeypatch):
    """Rather than an infinite one."""
    monkeypatch.setattr(tally.time, 'monotonic', lambda: 1.0)
    tallied = tally.Tally()
    tallied.add(b'')
    tallied.add(b'')
    assert tallied.rate() == 0.0
