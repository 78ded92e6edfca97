# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the search for other programs on the port."""

import os
from types import SimpleNamespace

from bahrs_driver.diagnostics.sharing_watch import LIFETIME, MIN_BAD_FRAMES, SharingWatch
from bahrs_driver.transport.processes import Process
from hypothesis import given, strategies as st

CAT = Process(4711, 'cat')


class Port:
    """A port with other programs on it, and what the driver notices of them."""

    def __init__(self, programs=()):
        """Begin without a sign."""
        self.link = SimpleNamespace(name='/dev/ttyX', path='/dev/ttyX', stolen=0)
        self.trouble = self.looks = 0
        self.programs = [Process(os.getpid(), 'driver'), *programs]
        self.watch = SharingWatch(self.link, lambda: self.trouble, self.look)

    def look(self, device):
        """Count."""
        assert device == '/dev/ttyX'
        self.looks += 1
        return self.programs


def test_nothing_is_looked_for_while_all_is_well():
    """Not even if another program only holds the port."""
    port = Port([CAT])
    for second in range(100):
        port.watch.check(float(second), silent=False)
    assert not port.looks and not port.watch.programs(99.0)


def test_damage_or_loss_is_a_reason_to_look():
    """The program is named, for a while."""
    port = Port([CAT])
    port.trouble = MIN_BAD_FRAMES
    port.watch.check(100.0, silent=False)
    assert port.watch.programs(100.0) == 'cat, process 4711'
    assert port.watch.command == '"fuser -v /dev/ttyX"'
    assert not port.watch.programs(100.1 + LIFETIME)


def test_a_program_of_another_user_is_known_by_what_it_takes():
    """It cannot be seen, but reads find nothing again and again."""
    port = Port()
    for second in range(100, 110):
        port.link.stolen += 1
        port.watch.check(float(second), silent=False)
    assert port.watch.programs(110.0) == 'one of another user'


def test_damage_alone_is_no_other_program():
    """Nor is silence."""
    port = Port()
    for second in range(100, 200):
        port.trouble += 100
        port.watch.check(float(second), silent=second % 2 == 0)
    assert 1 < port.looks < 8 and not port.watch.programs(200.0)


def test_a_name_is_made_printable():
    """A program may have any."""
    port = Port([Process(1, '\x1b[2J\n')])
    port.watch.check(100.0, silent=True)
    assert port.watch.programs(100.0) == r'\x1b[2J\x0a, process 1'


@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50), st.booleans()),
                max_size=60))
def test_looks_are_apart(steps):
    """Whatever the counters do: they begin again with each opening of the port."""
    port, seconds = Port([CAT]), 0.0
    for stolen, trouble, silent in steps:
        port.link.stolen = max(0, port.link.stolen + stolen)
        port.trouble = max(0, port.trouble + trouble)
        port.watch.check(seconds, silent)
        seconds += 1.0
    assert port.looks <= seconds / 3 + 1
