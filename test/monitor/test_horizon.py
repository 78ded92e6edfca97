# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the artificial horizon: where sky and ground are."""

from bahrs_driver.monitor.horizon import heading_tape, horizon, no_horizon
from hypothesis import given, strategies as st
import pytest

WIDTH, HEIGHT = 31, 11
GROUND = '░'


def ground_share(roll, pitch, columns=slice(None)):
    """Return how much of these columns is ground."""
    rows = horizon(roll, pitch, WIDTH, HEIGHT).plain.split('\n')
    cells = ''.join(row[columns] for row in rows)
    return cells.count(GROUND) / len(cells)


def test_level_flight():
    """Sky above, ground below, the aircraft in the middle."""
    rows = horizon(0.0, 0.0, WIDTH, HEIGHT).plain.split('\n')
    assert set(rows[0]) == {' '} and set(rows[-1]) == {GROUND}
    assert rows[HEIGHT // 2][WIDTH // 2] == '╋'


def test_nose_up_shows_sky_and_nose_down_ground():
    """The horizon goes the other way."""
    assert ground_share(0, 15) < ground_share(0, 0) < ground_share(0, -15)
    assert ground_share(0, 40) == 0
    assert ground_share(0, -80) > 0.8       # but for the rungs


@pytest.mark.parametrize('roll', [20, 45, 80])
def test_in_a_right_bank_the_ground_is_on_the_right(roll):
    """As the pilot sees it."""
    left, right = slice(0, 10), slice(21, None)
    assert ground_share(roll, 0, right) > ground_share(roll, 0, left)
    assert ground_share(-roll, 0, right) < ground_share(-roll, 0, left)


def test_upside_down():
    """The ground is above."""
    rows = horizon(180.0, 0.0, WIDTH, HEIGHT).plain.split('\n')
    assert set(rows[0]) == {GROUND} and set(rows[-1]) == {' '}


@given(roll=st.floats(-180, 180), pitch=st.floats(-90, 90),
       width=st.integers(20, 100), height=st.integers(2, 40))
def test_every_picture_fills_its_place(roll, pitch, width, height):
    """Whatever the attitude and the size."""
    rows = horizon(roll, pitch, width, height).plain.split('\n')
    assert [len(row) for row in rows] == [width] * height


@given(heading=st.floats(0, 360), width=st.integers(20, 100))
def test_the_tape_fills_its_place(heading, width):
    """Whatever the heading."""
    assert len(heading_tape(heading, width).plain) == width


def test_the_tape_has_the_heading_in_the_middle():
    """North where it is, east to the right of it."""
    tape = heading_tape(0.0, 61).plain
    assert tape[30] == 'N' and tape.index('N') < tape.index('E')
    assert heading_tape(270.0, 31).plain[15] == 'W'


def test_no_attitude():
    """A text replaces the picture."""
    text = no_horizon(31, 7, 'no attitude').plain
    assert 'no attitude' in text and GROUND not in text
