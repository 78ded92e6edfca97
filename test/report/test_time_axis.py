# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the times of samples: after losses, pauses and restarts, and with wrong messages."""

from bahrs_driver.report.time_axis import BreakKind, make_time_axis
import numpy as np
import pytest

TIMES = [('offset', np.int64), ('sequence', np.uint8), ('reference_sequence', np.uint8),
         ('device_time_us', np.uint64)]
PERIOD = 0.005


def make_axis(device_seconds, counts=None, label=1, every=20):
    """
    Return the time axis of samples with these device times.

    counts are those of the device, which go on where samples are lost. Every `every` samples a
    time message follows, whose label is ahead of the latest sample by `label`.
    """
    device_seconds = np.asarray(device_seconds, float)
    if counts is None:
        counts = np.round(device_seconds / PERIOD).astype(int)
    offset = 100 * np.arange(len(counts))
    times = np.array([(offset[i] + 50, 0, (counts[i] + label) % 256,
                       round(device_seconds[i] * 1e6) + 1_000_000)
                      for i in range(0, len(counts), every)], TIMES)
    return make_time_axis(offset, (np.asarray(counts) % 256).astype(np.uint8), times, PERIOD)


def regular(seconds=10.0):
    """Return the device times of consecutive samples."""
    return PERIOD * np.arange(round(seconds / PERIOD))


@pytest.mark.parametrize('label', [0, 1])
def test_consecutive_samples(label):
    """Their times are those of the device, whichever sample time messages name."""
    found = make_axis(regular(), label=label)
    assert found.seconds == pytest.approx(regular())
    assert found.device_us == pytest.approx(1e6 * regular() + 1e6)
    assert (found.label_ahead, found.breaks, found.rejected) == (label, [], 0)
    assert found.period == pytest.approx(PERIOD)


@pytest.mark.parametrize('missing', [1, 100, 255, 256, 700, 2560])
def test_lost_samples(missing):
    """Whole turns of the counter are detected by time messages."""
    device = np.delete(regular(30.0), slice(1003, 1003 + missing))
    found = make_axis(device)
    # The position of whole lost turns between two time messages is unknown.
    unsure = 20 if missing % 256 == 0 else 0
    assert np.count_nonzero(abs(found.seconds - device) > 1e-6) <= unsure
    (gap,) = found.breaks
    assert (gap.kind, gap.missing) == (BreakKind.LOST, missing)
    assert abs(gap.index - 1003) <= unsure


def test_pause():
    """The device does not send for a while, and its counter stands still."""
    device = regular()
    counts = np.arange(len(device))
    device[20:] += 2.7
    found = make_axis(device, counts)
    assert found.seconds == pytest.approx(device)
    (pause,) = found.breaks
    assert (pause.kind, pause.index) == (BreakKind.PAUSED, 20)
    assert pause.seconds == pytest.approx(2.705)


def test_restart():
    """Device time and the counter restart; no sample counts as lost."""
    first, second = regular(5.0), regular(3.0)
    counts = np.concatenate([np.arange(len(first)), np.arange(len(second))])
    found = make_axis(np.concatenate([first, second]), counts)
    assert [restart.kind for restart in found.breaks] == [BreakKind.RESTARTED]
    assert np.all(np.diff(found.seconds) > 0)
    assert found.seconds[-1] == pytest.approx(first[-1] + 1.0 + second[-1], abs=1e-6)
    assert found.device_us[len(first)] == pytest.approx(1e6)


def test_wrong_time_message():
    """It is rejected, as its neighbours agree."""
    offset = 100 * np.arange(2000)
    times = np.array([(offset[i] + 50, 0, (i + 1) % 256, 5000 * i)
                      for i in range(20, 2000, 20)], TIMES)
    times['device_time_us'][19] += 77_000_000
    found = make_time_axis(offset, (np.arange(2000) % 256).astype(np.uint8), times, PERIOD)
    assert (found.rejected, found.breaks) == (1, [])
    assert found.seconds == pytest.approx(PERIOD * np.arange(2000))


def test_without_time_messages():
    """Samples are a nominal period apart."""
    numbers = np.arange(10, dtype=np.uint8)
    found = make_time_axis(numbers, numbers, np.empty(0, TIMES), PERIOD)
    assert found.seconds == pytest.approx(PERIOD * np.arange(10))
    assert found.label_ahead is None and np.isnan(found.device_us).all()


def test_no_samples():
    """The axis is empty."""
    found = make_time_axis(np.empty(0, int), np.empty(0, np.uint8), np.empty(0, TIMES), PERIOD)
    assert len(found.seconds) == 0 and found.breaks == []
