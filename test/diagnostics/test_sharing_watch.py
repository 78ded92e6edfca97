# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the search for other programs that read the port."""

import os
from types import SimpleNamespace

from bahrs_driver.diagnostics.sharing_watch import LIFETIME, MIN_BAD_FRAMES, SharingWatch
from bahrs_driver.transport.processes import Process
from hypothesis import given, strategies as st

CAT = Process(4711, 'cat')


class Port:
    """A port with other programs, and the signs of them."""

    def __init__(self, programs=()):
        """Begin without signs."""
        self.link = SimpleNamespace(name='/dev/ttyX', path='/dev/ttyX', stolen=0)
        self.bad_frames = self.searches = 0
        self.programs = [Process(os.getpid(), 'driver'), *programs]
        self.watch = SharingWatch(self.link, lambda: self.bad_frames, self.search)

    def search(self, device):
        """Count the search and return the programs."""
        assert device == '/dev/ttyX'
        self.searches += 1
        return self.programs


def test_no_search_without_a_sign():
    """Another program may have the port open without reading it."""
    port = Port([CAT])
    for second in range(100):
        port.watch.check(float(second), silent=False)
    assert not port.searches and not port.watch.describe_programs(99.0)


def test_damage_or_loss_starts_a_search():
    """The program is named for a while."""
    port = Port([CAT])
    port.bad_frames = MIN_BAD_FRAMES
    port.watch.check(100.0, silent=False)
    assert port.watch.describe_programs(100.0) == 'cat, process 4711'
    assert port.watch.command == '"fuser -v /dev/ttyX"'
    assert not port.watch.describe_programs(100.1 + LIFETIME)


def test_stolen_bytes_prove_a_program_of_another_user():
    """Its processes are not visible, but reads repeatedly return no bytes."""
    port = Port()
    for second in range(100, 110):
        port.link.stolen += 1
        port.watch.check(float(second), silent=False)
    assert port.watch.describe_programs(110.0) == 'one of another user'


def test_damage_alone_proves_no_other_program():
    """Silence proves none, either."""
    port = Port()
    for second in range(100, 200):
        port.bad_frames += 100
        port.watch.check(float(second), silent=second % 2 == 0)
    assert 1 < port.searches < 8 and not port.watch.describe_programs(200.0)


def test_a_name_is_made_printable():
    """A program may have any name."""
    port = Port([Process(1, '\x1b[2J\n')])
    port.watch.check(100.0, silent=True)
    assert port.watch.describe_programs(100.0) == r'\x1b[2J\x0a, process 1'


@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50), st.booleans()),
                max_size=60))
def test_searches_are_limited(steps):
    """For any changes of the counters, which restart when the port is opened."""
    port, seconds = Port([CAT]), 0.0
    for stolen, bad_frames, silent in steps:
        port.link.stolen = max(0, port.link.stolen + stolen)
        port.bad_frames = max(0, port.bad_frames + bad_frames)
        port.watch.check(seconds, silent)
        seconds += 1.0
    assert port.searches <= seconds / 3 + 1
