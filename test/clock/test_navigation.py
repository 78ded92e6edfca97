# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the sample that a navigation message was computed from."""

import random

from bahrs_driver.clock.navigation import NavigationCounter


def stream(count, first_inertial=0, first_navigation=0):
    """Yield messages: ('i', counter, index) and ('n', counter, index of its sample)."""
    for index in range(count):
        yield 'i', (first_inertial + index) % 256, index
        if index % 2 == 0:
            yield 'n', (first_navigation + index // 2) % 256, index


def pairs(messages):
    """Return (true index, found index) of the sample of each navigation message."""
    pairing, latest, found = NavigationCounter(2, prior=0), None, []
    for kind, counter, index in messages:
        if kind == 'i':
            latest = counter, index
        elif latest is not None:
            pairing.pair(counter, latest[0])
            found.append((index, latest[1] if pairing.matches(counter, latest[0]) else None))
    return found


def test_every_navigation_message_gets_its_sample():
    """Both counters wrap many times."""
    found = pairs(stream(2000))
    assert len(found) == 1000
    assert all(got == wanted for wanted, got in found)


def test_counters_may_have_any_difference():
    """A driver may start at any time."""
    found = pairs(stream(600, 77, 200))
    assert len(found) == 300 and all(got == wanted for wanted, got in found)


def test_a_lost_sample_is_not_replaced_by_its_neighbour():
    """Its navigation message gets no other sample, and the next one gets its own."""
    messages = [m for m in stream(100) if m[:2] != ('i', 40)]
    found = dict(pairs(messages))
    assert found[40] is None
    assert found[38] == 38 and found[42] == 42


def test_losses_of_either_kind_never_give_a_wrong_sample():
    """One message in ten is lost at random; at least one pair in five remains."""
    chance = random.Random(4)
    messages = [m for m in stream(20000) if chance.random() > 0.1]
    found = pairs(messages)
    right = sum(got == wanted for wanted, got in found)
    wrong = sum(got is not None and got != wanted for wanted, got in found)
    assert right > 0.85 * len(found)
    assert wrong == 0


def test_a_few_agreeing_pairs_show_a_restart():
    """The counters begin again with another difference."""
    found = pairs([*stream(100), *stream(100, 13, 200)])[50:]
    assert [got for _, got in found[:4]] == [None] * 4
    assert all(got == wanted for wanted, got in found[4:])
