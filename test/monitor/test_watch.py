# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what the monitor keeps."""

from bahrs_driver.monitor import watch


def test_hours_without_a_look_take_no_memory(monkeypatch):
    """Only arrivals of the window are kept, though nobody asks for the rate."""
    now = [0.0]
    monkeypatch.setattr(watch.time, 'monotonic', lambda: now[0])
    tally = watch.Tally()
    for _ in range(10_000):
        now[0] += 0.01
        tally.add(b'message')
    assert len(tally._arrivals) <= watch.RATE_WINDOW / 0.01 + 1
    assert tally.count == 10_000
    assert abs(tally.rate() - 100.0) < 1e-6
