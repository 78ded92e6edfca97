# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of when something is due."""

from bahrs_driver.protocol.schedule import CATCH_UP, Schedule

MS = 1_000_000


def begun(rates, now=0):
    """Return a schedule in which everything is due."""
    schedule = Schedule(rates)
    schedule.start(now)
    return schedule


def test_everything_is_due_at_the_start_in_the_order_given():
    """But for what is never due."""
    schedule = begun({'b': 10.0, 'never': 0.0, 'a': 50.0})
    assert schedule.due(0) == ['b', 'a']


def test_each_kind_has_a_grid_of_its_own():
    """Being late once does not move it."""
    schedule = begun({'a': 50.0})
    schedule.advance('a', 7 * MS)
    assert schedule.due(19 * MS) == [] and schedule.next_after(7 * MS) == 20 * MS
    assert schedule.due(20 * MS) == ['a']
    schedule.advance('a', 33 * MS)
    assert schedule.next_after(33 * MS) == 40 * MS


def test_what_waited_longest_is_first():
    """Whatever the order given."""
    schedule = begun({'a': 50.0, 'b': 100.0})
    schedule.advance('a', 0)
    schedule.advance('b', 0)
    assert schedule.due(20 * MS) == ['b', 'a']


def test_a_few_turns_are_made_up_for_and_others_left_out():
    """On the grid still."""
    schedule = begun({'a': 50.0})
    schedule.advance('a', 0)
    schedule.advance('a', 20 * MS * CATCH_UP)
    assert schedule.skipped == 0 and schedule.due(20 * MS * CATCH_UP) == ['a']
    schedule.advance('a', 20 * MS * (CATCH_UP + 9))
    assert schedule.skipped == 7
    assert schedule.next_after(0) % (20 * MS) == 0


def test_nothing_to_do_is_never_due():
    """No rates, or none above zero."""
    schedule = begun({'a': 0.0})
    assert schedule.due(10 ** 12) == [] and schedule.next_after(0) is None
