# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of counting names from the wire in bounded memory."""

from collections import Counter
import random

from bahrs_driver.protocol.top_counter import OTHER, SHOWN, TopCounter, TRACKED
from hypothesis import given, settings, strategies as st


def counted(names):
    """Return a counter that has counted the names."""
    counter = TopCounter()
    for name in names:
        counter.add(name)
    return counter


def test_few_names_are_all_shown():
    """As by a Counter."""
    counter = counted('abracadabra')
    assert counter == Counter('abracadabra') and counter.total() == 11
    assert 'b' in counter and 'x' not in counter and OTHER not in counter
    assert counter['a'] == 5 and len(counter) == 5 and list(counter)[0] == 'a'
    assert repr(counted('aab')) == "TopCounter({'a': 2, 'b': 1})"
    assert not TopCounter()


@settings(deadline=None)
@given(st.dictionaries(st.text(max_size=3), st.integers(1, 40), max_size=200),
       st.randoms(use_true_random=False))
def test_the_most_frequent_names_are_shown_with_their_counts(counts, chance):
    """OTHER has the rest of the sum, for any order of arrival."""
    counts.pop(OTHER, None)
    names = [name for name, count in counts.items() for _ in range(count)]
    chance.shuffle(names)
    counter = counted(names)
    shown = {name: count for name, count in counter.items() if name != OTHER}
    assert sorted(shown.values()) == sorted(counts.values())[-SHOWN:]
    assert shown.items() <= counts.items()
    assert counter.total() == len(names) == sum(counter.values())
    assert (OTHER in counter) == (len(counts) > SHOWN)


def test_a_flood_of_names_does_not_grow_it():
    """It does not hide a name that is frequent, from the start or later."""
    chance, counter, sizes = random.Random(1), TopCounter(), []
    for turn in range(100_000):
        counter.add(f'0x{chance.getrandbits(24):06X}')
        if turn % 10 == 0:
            counter.add('from the start')
        if turn > 50_000 and turn % 10 == 0:
            counter.add('late')
        sizes.append(len(counter._counts) + len(counter._head_start))
    assert max(sizes) <= 2 * TRACKED
    assert len(counter) == SHOWN + 1
    assert counter['from the start'] == 10_000 and counter['late'] == 4999
    assert counter.total() == sum(counter.values()) == 114_999


def test_formerly_frequent_names_are_replaced_by_presently_frequent_ones():
    """However many there were."""
    counter = TopCounter()
    for name in range(TRACKED):
        counter.add(f'past {name}', 300)
    for turn in range(60_000):
        counter.add(f'0x{turn:06X}')
        if turn % 10 == 0:
            counter.add('present')
    assert counter['present'] > 3000
