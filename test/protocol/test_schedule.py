# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the schedule of periodic turns."""

from bahrs_driver.protocol.schedule import CATCH_UP, Schedule

MS = 1_000_000


def begun(rates, now=0):
    """Return a schedule in which everything is due."""
    schedule = Schedule(rates)
    schedule.start(now)
    return schedule


def test_all_kinds_are_due_at_the_start_in_the_given_order():
    """Except kinds that are never due."""
    schedule = begun({'b': 10.0, 'never': 0.0, 'a': 50.0})
    assert schedule.due(0) == ['b', 'a']


def test_each_kind_has_its_own_grid():
    """A late turn does not shift it."""
    schedule = begun({'a': 50.0})
    schedule.advance('a', 7 * MS)
    assert schedule.due(19 * MS) == [] and schedule.next_after(7 * MS) == 20 * MS
    assert schedule.due(20 * MS) == ['a']
    schedule.advance('a', 33 * MS)
    assert schedule.next_after(33 * MS) == 40 * MS


def test_the_longest_overdue_kind_is_first():
    """Whatever the given order."""
    schedule = begun({'a': 50.0, 'b': 100.0})
    schedule.advance('a', 0)
    schedule.advance('b', 0)
    assert schedule.due(20 * MS) == ['b', 'a']


def test_a_few_late_turns_are_made_up_for_and_others_skipped():
    """The grid does not change."""
    schedule = begun({'a': 50.0})
    schedule.advance('a', 0)
    schedule.advance('a', 20 * MS * CATCH_UP)
    assert schedule.skipped == 0 and schedule.due(20 * MS * CATCH_UP) == ['a']
    schedule.advance('a', 20 * MS * (CATCH_UP + 9))
    assert schedule.skipped == 7
    assert schedule.next_after(0) % (20 * MS) == 0


def test_without_rates_nothing_is_due():
    """There are none, or none above zero."""
    schedule = begun({'a': 0.0})
    assert schedule.due(10 ** 12) == [] and schedule.next_after(0) is None
