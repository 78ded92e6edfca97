# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the axis of time: samples lost, pauses, restarts and messages that are wrong."""

from bahrs_driver.report.time_axis import BreakKind, make_time_axis
import numpy as np
import pytest

TIMES = [('offset', np.int64), ('sequence', np.uint8), ('reference_sequence', np.uint8),
         ('device_time_us', np.uint64)]
PERIOD = 0.005


def made(device_seconds, counts=None, label=1, every=20):
    """
    Return the time axis of samples with these device times.

    counts are those of the device, which go on where samples are lost; a time message follows
    every so many samples.
    """
    device_seconds = np.asarray(device_seconds, float)
    if counts is None:
        counts = np.round(device_seconds / PERIOD).astype(int)
    offset = 100 * np.arange(len(counts))
    times = np.array([(offset[i] + 50, 0, (counts[i] + label) % 256,
                       round(device_seconds[i] * 1e6) + 1_000_000)
                      for i in range(0, len(counts), every)], TIMES)
    return make_time_axis(offset, (np.asarray(counts) % 256).astype(np.uint8), times)


def regular(seconds=10.0):
    """Return the device times of samples that all came."""
    return PERIOD * np.arange(round(seconds / PERIOD))


@pytest.mark.parametrize('label', [0, 1])
def test_samples_that_all_came(label):
    """Their times are those of the device, whichever sample time messages name."""
    found = made(regular(), label=label)
    assert found.seconds == pytest.approx(regular())
    assert found.device_us == pytest.approx(1e6 * regular() + 1e6)
    assert (found.label_ahead, found.breaks, found.rejected) == (label, [], 0)
    assert found.period == pytest.approx(PERIOD)


@pytest.mark.parametrize('missing', [1, 100, 255, 256, 700, 2560])
def test_samples_lost(missing):
    """Also whole turns of the counter, which only time messages show."""
    device = np.delete(regular(30.0), slice(1003, 1003 + missing))
    found = made(device)
    # The position of whole lost turns between two time messages is unknown.
    unsure = 20 if missing % 256 == 0 else 0
    assert np.count_nonzero(abs(found.seconds - device) > 1e-6) <= unsure
    (gap,) = found.breaks
    assert (gap.kind, gap.missing) == (BreakKind.LOST, missing)
    assert abs(gap.index - 1003) <= unsure


def test_a_pause():
    """The device sends nothing, and counts nothing, as after power-on."""
    device = regular()
    counts = np.arange(len(device))
    device[20:] += 2.7
    found = made(device, counts)
    assert found.seconds == pytest.approx(device)
    (pause,) = found.breaks
    assert (pause.kind, pause.index) == (BreakKind.PAUSED, 20)
    assert pause.seconds == pytest.approx(2.705)


def test_a_restart():
    """Device time and the counter restart; no sample counts as lost."""
    first, second = regular(5.0), regular(3.0)
    counts = np.concatenate([np.arange(len(first)), np.arange(len(second))])
    found = made(np.concatenate([first, second]), counts)
    assert [each.kind for each in found.breaks] == [BreakKind.RESTARTED]
    assert np.all(np.diff(found.seconds) > 0)
    assert found.seconds[-1] == pytest.approx(first[-1] + 1.0 + second[-1], abs=1e-6)
    assert found.device_us[len(first)] == pytest.approx(1e6)


def test_a_time_message_that_is_wrong():
    """It is rejected, for its neighbours agree."""
    offset = 100 * np.arange(2000)
    times = np.array([(offset[i] + 50, 0, (i + 1) % 256, 5000 * i)
                      for i in range(20, 2000, 20)], TIMES)
    times['device_time_us'][19] += 77_000_000
    found = make_time_axis(offset, (np.arange(2000) % 256).astype(np.uint8), times)
    assert (found.rejected, found.breaks) == (1, [])
    assert found.seconds == pytest.approx(PERIOD * np.arange(2000))


def test_without_time_messages():
    """Samples are a nominal period apart."""
    found = make_time_axis(np.arange(10), np.arange(10).astype(np.uint8), np.empty(0, TIMES))
    assert found.seconds == pytest.approx(PERIOD * np.arange(10))
    assert found.label_ahead is None and np.isnan(found.device_us).all()


def test_nothing():
    """There are no breaks."""
    found = make_time_axis(np.empty(0, int), np.empty(0, np.uint8), np.empty(0, TIMES))
    assert len(found.seconds) == 0 and found.breaks == []
