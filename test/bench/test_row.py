# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Rows of the benchmark: what is compared with a bound, and what fails."""

from harness.row import at_least, at_most, failures, Fault, Row
import pytest


def row(ours, limit, floor=2.0, target=None):
    """Return a row in ms."""
    return Row('latency', ours, 'ms', limit, target, floor, 'bare')


@pytest.mark.parametrize('limit, largest', [
    (at_most('ours', 5.0), 5.0), (at_most('ratio', 1.5), 3.0), (at_most('difference', 0.5), 2.5)])
def test_what_should_be_small_fails_above_its_limit(limit, largest):
    """Equal holds."""
    assert not row(largest, limit).failed
    assert row(largest + 0.01, limit).failed


@pytest.mark.parametrize('limit, smallest', [
    (at_least('ours', 5.0), 5.0), (at_least('ratio', 1.5), 3.0)])
def test_what_should_be_large_fails_below_its_limit(limit, smallest):
    """Equal holds."""
    assert not row(smallest, limit).failed
    assert row(smallest - 0.01, limit).failed


def test_a_missed_target_is_no_failure():
    """It is shown, and the run goes on."""
    missed = row(4.0, at_most('ratio', 3), target=at_most('ratio', 1.25))
    assert missed.holds(missed.target) is False and not missed.failed


def test_without_a_floor_only_the_figure_itself_is_judged():
    """The others are not known."""
    assert row(9.0, at_most('ratio', 1), None).holds(at_most('ratio', 1)) is None
    assert not row(9.0, at_most('difference', 1), None).failed
    assert row(9.0, at_most('ours', 1), None).failed


def test_failures_name_rows_and_groups():
    """Both fail a run."""
    rows = [row(3.0, at_most('ratio', 1)), row(3.0, at_most('ratio', 2))]
    assert failures(rows, [Fault('arrays', 'no file')]) == [
        'latency: beyond its limit', 'arrays: no file']
    assert failures(rows[1:], []) == []
