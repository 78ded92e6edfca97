# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of how the node is chosen that a user means."""

from bahrs_driver.ros.node_names import NodeChoice, Selection, SETTLE_TIME
import pytest

LEFT, RIGHT, ROOT = '/left/bahrs_driver', '/right/bahrs_driver', '/bahrs_driver'


@pytest.mark.parametrize('selection, matching', [
    (Selection(), [LEFT, RIGHT, ROOT]),
    (Selection('bahrs_driver'), [LEFT, RIGHT, ROOT]),
    (Selection('bahrs_driver', '/'), [ROOT]),
    (Selection('', '/left'), [LEFT]),
    (Selection('front'), []),
])
def test_matches(selection, matching):
    """By name, by namespace, or both."""
    assert [name for name in (LEFT, RIGHT, ROOT) if selection.matches(name)] == matching
    assert selection.exact == (matching[0] if all(selection) else '')


def test_the_first_is_taken_at_once():
    """It is kept, even if another one appears much later."""
    choice = NodeChoice(Selection())
    choice.offer([], 0.0)
    choice.offer(['/other/node'][:0], 10.0)
    assert not choice.chosen and not choice.settled(10.0)
    choice.offer([RIGHT], 20.0)
    assert choice.chosen == RIGHT
    choice.offer([LEFT, RIGHT], 20.1 + SETTLE_TIME)
    assert (choice.chosen, choice.several) == (RIGHT, [])
    assert choice.settled(20.1 + SETTLE_TIME)


@pytest.mark.parametrize('looks', [[[LEFT, RIGHT]], [[LEFT], [RIGHT]], [[RIGHT], [LEFT, RIGHT]]])
def test_several_that_are_found_soon_after_each_other(looks):
    """Within the time that discovery needs for running nodes."""
    choice = NodeChoice(Selection())
    for index, names in enumerate(looks):
        choice.offer(names, 0.4 * index)
    assert choice.several == [LEFT, RIGHT]


def test_an_exact_selection_needs_no_search():
    """Nodes that do not match have no effect."""
    choice = NodeChoice(Selection('bahrs_driver', '/left'))
    assert choice.chosen == LEFT and choice.settled(0.0)
    choice.offer([LEFT, RIGHT], 0.0)
    assert choice.several == []
