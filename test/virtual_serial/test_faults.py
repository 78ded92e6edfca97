# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of transmission faults."""

from bahrs_driver.virtual_serial.faults import Faults, NAMES, parse_fault
import pytest

FRAME = bytes(range(40))
FRAMES = 5000


def results(seed=1, **rates):
    """Return the counts of faults and the results for many equal frames."""
    faults = Faults(seed, {name.rstrip('_'): rate for name, rate in rates.items()})
    return faults.counts, [faults.apply(FRAME) for _ in range(FRAMES)]


def test_without_faults_everything_arrives():
    """Frames are unchanged, and no fault is counted."""
    counts, frames = results()
    assert frames == [FRAME] * FRAMES and not counts


def test_every_bit_flip_is_counted():
    """Each flip inverts one bit, at the requested rate."""
    counts, frames = results(bit_flip=1e-3)
    flipped = sum(bin(a ^ b).count('1') for frame in frames for a, b in zip(frame, FRAME))
    assert all(len(frame) == len(FRAME) for frame in frames)
    assert flipped == counts['bit_flip'] == pytest.approx(200, abs=60)


@pytest.mark.parametrize(('name', 'change'), [
    ('drop_byte', -1), ('repeat_byte', 1), ('insert_byte', 1)])
def test_every_byte_too_few_or_too_many_is_counted(name, change):
    """The other bytes do not change."""
    counts, frames = results(**{name: 1e-3})
    assert sum(len(frame) - len(FRAME) for frame in frames) == change * counts[name]
    assert counts[name] == pytest.approx(200, abs=60)
    for frame in frames:
        if len(frame) == len(FRAME) + change:
            start = next((i for i, (a, b) in enumerate(zip(frame, FRAME)) if a != b), None)
            if start is not None:
                assert frame[:start] + frame[start + max(change, 0):] in (
                    FRAME, FRAME[:start] + FRAME[start + 1:])


def test_a_repeated_byte_stands_beside_itself():
    """With every byte repeated, each byte stands twice."""
    _, frames = results(repeat_byte=1.0)
    assert frames[0] == bytes(byte for byte in FRAME for _ in range(2))


@pytest.mark.parametrize('rate', [0.01, 0.2])
def test_every_break_is_counted(rate):
    """The frame is truncated at a random byte."""
    counts, frames = results(break_=rate)
    cut = [frame for frame in frames if frame != FRAME]
    assert len(cut) == counts['break'] == pytest.approx(rate * FRAMES, rel=0.4)
    assert all(0 < len(frame) < len(FRAME) and FRAME.startswith(frame) for frame in cut)


@pytest.mark.parametrize('rate', [0.01, 1.0])
def test_every_lost_frame_is_counted(rate):
    """No byte of the frame remains."""
    counts, frames = results(drop_frame=rate)
    assert frames.count(b'') == counts['drop_frame'] == pytest.approx(rate * FRAMES, rel=0.4)


def test_the_seed_decides():
    """The rate of one fault does not move another fault."""
    rates = {'bit_flip': 1e-3, 'drop_frame': 1e-2}
    assert results(1, **rates) == results(1, **rates)
    assert results(1, **rates) != results(2, **rates)
    lost = [index for index, frame in enumerate(results(1, **rates)[1]) if not frame]
    assert lost == [index for index, frame in enumerate(results(1, drop_frame=1e-2)[1])
                    if not frame]


def test_rates_can_change_while_it_runs():
    """A new rate holds from the next frame on."""
    faults = Faults(1)
    assert faults.apply(FRAME) == FRAME
    faults.set_rate('drop_frame', 1.0)
    assert faults.apply(FRAME) == b''
    faults.set_rate('drop_frame', 0.0)
    assert faults.apply(FRAME) == FRAME


def test_all_faults_at_once():
    """This holds for single bytes and for rates of 1."""
    faults = Faults(1, dict.fromkeys(set(NAMES) - {'drop_frame'}, 1.0))
    for frame in (b'', b'N', FRAME):
        assert len(faults.apply(frame)) <= 3 * len(frame)


@pytest.mark.parametrize(('text', 'says'), [
    ('rust=0.1', "no fault 'rust', only bit_flip"), ('bit_flip', "rate of bit_flip is ''"),
    ('bit_flip=2', 'from 0 to 1'), ('bit_flip=-1', 'from 0 to 1'), ('bit_flip=x', "'x'")])
def test_an_invalid_text_is_rejected(text, says):
    """The error is one sentence."""
    with pytest.raises(ValueError, match=says):
        parse_fault(text)


def test_a_text_becomes_name_and_rate():
    """The form is that of the command line."""
    assert parse_fault('bit_flip=0.001') == ('bit_flip', 0.001)
