# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the thread that asks, with a conversation that is a script."""

import queue
import threading
import time

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.transport.link import LinkError
from bahrs_driver.transport.requester import Requester
import pytest
from support.processes import wait_for

LONG = 30.0             # s, for what should be at once
FRAME = Frame(0, b'answer', 'big')


class Line:
    """A link that hands on what is written, and may refuse it."""

    byte_time_ns = 1000

    def __init__(self):
        """Begin whole."""
        self.written = queue.Queue()
        self.broken = False
        self.waits = []

    def write(self, data, wait=True):
        """Take it, or not."""
        self.waits.append(wait)
        if self.broken:
            raise LinkError('gone')
        self.written.put(data)


class Script:
    """Asks again for each answer, and by itself when the time comes."""

    def __init__(self):
        """Ask nothing."""
        self.calls = []
        self.next = None
        self.sends = 0

    def begin(self, now, byte_time):
        """Ask at once."""
        self.calls.append(('begin', byte_time))
        self.next = now

    def end(self):
        """Ask nothing."""
        self.calls.append('end')
        self.next = None

    def due(self, now):
        """Return when."""
        return self.next

    def send(self, now):
        """Return a request if it is time."""
        self.sends += 1
        if self.next is None or now < self.next:
            return b''
        self.next = None
        return b'request'

    def receive(self, frame, now):
        """Ask again a little later."""
        self.next = now + 1_000_000
        return 'message', frame

    def expected(self):
        """Return a word."""
        return ['answer']


@pytest.fixture
def asking():
    """Give line, script and requester, whose thread runs."""
    line, script = Line(), Script()
    requester = Requester(line, script)
    thread = threading.Thread(target=requester.run)
    thread.start()
    yield line, script, requester
    requester.stop()
    thread.join(LONG)
    assert not thread.is_alive()


def test_it_asks_when_the_link_is_opened_and_when_an_answer_has_come(asking):
    """The answer is what the conversation makes of it."""
    line, script, requester = asking
    requester.opened()
    assert line.written.get(timeout=LONG) == b'request'
    for _ in range(20):
        assert requester.decode(FRAME) == ('message', FRAME)
        assert line.written.get(timeout=LONG) == b'request'
    requester.lost()
    assert script.calls == [('begin', 1000), 'end'] and requester.expected() == ['answer']


def test_it_sleeps_when_there_is_nothing_to_do(asking):
    """It does not look again and again."""
    line, script, requester = asking
    requester.opened()
    line.written.get(timeout=LONG)
    time.sleep(0.2)
    assert script.sends < 10


def test_it_sleeps_however_far_off_its_next_turn_is(asking):
    """A rate may be so low that the time to the next turn is more than a lock takes."""
    line, script, requester = asking
    requester.opened()
    line.written.get(timeout=LONG)
    sends = script.sends
    script.receive = lambda frame, now: setattr(script, 'next', now + 10 ** 22)
    requester.decode(FRAME)
    deadline = time.monotonic() + LONG
    while script.sends < sends + 2 and time.monotonic() < deadline:
        time.sleep(0.001)
    requester.opened()
    assert line.written.get(timeout=LONG) == b'request'


def test_a_line_that_is_gone_does_not_end_it(asking):
    """The reader tells of it; later requests go out."""
    line, script, requester = asking
    line.broken = True
    requester.opened()
    deadline = time.monotonic() + LONG
    while script.next is not None and time.monotonic() < deadline:
        time.sleep(0.001)
    line.broken = False
    requester.opened()
    assert line.written.get(timeout=LONG) == b'request'


def test_the_thread_that_reads_does_not_wait_for_the_device(asking):
    """What is written on it is taken at once, or lost."""
    line, script, requester = asking
    requester.opened()
    line.written.get(timeout=LONG)
    script.receive = lambda frame, now: setattr(script, 'next', now)
    requester.decode(FRAME)
    line.written.get(timeout=LONG)
    assert line.waits == [True, False]


def test_why_a_request_was_not_written_is_known_until_one_is(asking):
    """Or until the link is opened again."""
    line, script, requester = asking
    line.broken = True
    requester.opened()
    assert wait_for(lambda: requester.write_error == 'gone')
    line.broken = False
    script.next = 0
    requester.decode(FRAME)
    line.written.get(timeout=LONG)
    assert wait_for(lambda: not requester.write_error)
    requester.write_error = 'gone'
    requester.lost()
    assert not requester.write_error


def test_it_stops_at_once_before_anything_was_opened():
    """And if it is stopped before it runs."""
    requester = Requester(Line(), Script())
    requester.stop()
    requester.run()
