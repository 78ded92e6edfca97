# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test where sky and ground are on the artificial horizon."""

from bahrs_driver.monitor.horizon import heading_tape, horizon, no_horizon
from hypothesis import given, strategies as st
import pytest

WIDTH, HEIGHT = 31, 11
GROUND = '░'


def ground_share(roll, pitch, columns=slice(None)):
    """Return the share of ground in some columns."""
    rows = horizon(roll, pitch, WIDTH, HEIGHT).plain.split('\n')
    cells = ''.join(row[columns] for row in rows)
    return cells.count(GROUND) / len(cells)


def test_level_flight():
    """Sky is above, ground below, the aircraft in the middle."""
    rows = horizon(0.0, 0.0, WIDTH, HEIGHT).plain.split('\n')
    assert set(rows[0]) == {' '} and set(rows[-1]) == {GROUND}
    assert rows[HEIGHT // 2][WIDTH // 2] == '╋'


def test_pitch():
    """Nose up shows more sky, nose down more ground."""
    assert ground_share(0, 15) < ground_share(0, 0) < ground_share(0, -15)
    assert ground_share(0, 40) == 0
    assert ground_share(0, -80) > 0.8       # except for the rungs


@pytest.mark.parametrize('roll', [20, 45, 80])
def test_roll(roll):
    """In a right bank the pilot sees more ground on the right."""
    left, right = slice(0, 10), slice(21, None)
    assert ground_share(roll, 0, right) > ground_share(roll, 0, left)
    assert ground_share(-roll, 0, right) < ground_share(-roll, 0, left)


def test_upside_down():
    """Ground is above, sky below."""
    rows = horizon(180.0, 0.0, WIDTH, HEIGHT).plain.split('\n')
    assert set(rows[0]) == {GROUND} and set(rows[-1]) == {' '}


@given(roll=st.floats(-180, 180), pitch=st.floats(-90, 90),
       width=st.integers(20, 100), height=st.integers(2, 40))
def test_size_of_the_horizon(roll, pitch, width, height):
    """Every picture has the requested size."""
    rows = horizon(roll, pitch, width, height).plain.split('\n')
    assert [len(row) for row in rows] == [width] * height


@given(heading=st.floats(0, 360), width=st.integers(20, 100))
def test_width_of_the_heading_tape(heading, width):
    """Every tape has the requested width."""
    assert len(heading_tape(heading, width).plain) == width


def test_heading_tape():
    """The heading is in the middle, and east is to the right of north."""
    tape = heading_tape(0.0, 61).plain
    assert tape[30] == 'N' and tape.index('N') < tape.index('E')
    assert heading_tape(270.0, 31).plain[15] == 'W'


def test_no_attitude():
    """A text replaces the picture."""
    text = no_horizon(31, 7, 'no attitude').plain
    assert 'no attitude' in text and GROUND not in text
