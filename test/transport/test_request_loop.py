# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the loop that writes requests, with a scripted scheduler."""

import queue
import threading
import time

from bahrs_driver.errors import LinkError
from bahrs_driver.transport.request_loop import now_ns, RequestLoop
import pytest
from support.waiting import wait_for

LONG = 30.0             # s; limit for events that follow at once


class Line:
    """A link that keeps what is written, and may fail."""

    def __init__(self):
        self.written = queue.Queue()
        self.broken = False
        self.waits = []

    def write(self, data, wait=True):
        """Keep the bytes; raise LinkError if broken."""
        self.waits.append(wait)
        if self.broken:
            raise LinkError('gone')
        self.written.put(data)


class Script:
    """A scheduler with one request at a time, due when a test sets its time."""

    def __init__(self):
        self.next = None
        self.sends = 0
        self.errors = []

    def due(self, now):
        """Return the time of the request."""
        return self.next

    def send(self, now):
        """Return the request if it is due."""
        self.sends += 1
        if self.next is None or now < self.next:
            return b''
        self.next = None
        return b'request'

    def record_write(self, error, now):
        """Keep the error."""
        self.errors.append(error)


@pytest.fixture
def running():
    """Give line, script and loop, whose thread runs."""
    line, script = Line(), Script()
    loop = RequestLoop(line, script)
    thread = threading.Thread(target=loop.run)
    thread.start()
    yield line, script, loop
    loop.stop()
    thread.join(LONG)
    assert not thread.is_alive()


def schedule(loop, script, delay=0):
    """Schedule a request after a delay in ns, and wake the loop."""
    with loop.lock:
        script.next = now_ns() + delay
        loop.changed.notify_all()


def test_a_request_is_written_when_it_is_due(running):
    """At once, or after a while; a later turn may become an earlier one."""
    line, script, loop = running
    schedule(loop, script)
    assert line.written.get(timeout=LONG) == b'request'
    schedule(loop, script, 10 ** 15)
    begin = now_ns()
    schedule(loop, script, 20_000_000)
    assert line.written.get(timeout=LONG) == b'request'
    assert now_ns() - begin >= 20_000_000


def test_what_an_answer_makes_due_is_written_on_the_thread_that_reads(running):
    """It must not wait for a port that accepts nothing, because it reads the answers."""
    line, script, loop = running
    with loop.lock:
        script.next = now_ns()
    loop.send_due()
    assert line.written.get(timeout=LONG) == b'request'
    assert line.waits[-1:] == [False] and wait_for(lambda: script.errors == [''])


def test_all_requests_that_are_due_are_written_at_once(running):
    """In pipelined mode several may be."""
    line, script, loop = running
    pending = [b'one', b'two', b'three']
    script.send = lambda now: pending.pop(0) if pending else b''
    loop.send_due()
    assert [line.written.get(timeout=LONG) for _ in range(3)] == [b'one', b'two', b'three']


def test_the_loop_sleeps_while_nothing_is_due(running):
    """It does not poll."""
    line, script, loop = running
    schedule(loop, script)
    line.written.get(timeout=LONG)
    assert wait_for(lambda: script.errors)
    sends = script.sends
    time.sleep(0.2)
    assert script.sends < sends + 3


def test_a_turn_may_be_further_away_than_a_lock_can_wait(running):
    """The loop sleeps in parts."""
    line, script, loop = running
    schedule(loop, script, 10 ** 22)
    loop.send_due()
    assert wait_for(lambda: script.sends >= 2)
    schedule(loop, script)
    assert line.written.get(timeout=LONG) == b'request'


def test_a_write_error_is_recorded_and_later_requests_are_written(running):
    """The thread that reads reports the loss of the port."""
    line, script, loop = running
    line.broken = True
    schedule(loop, script)
    assert wait_for(lambda: script.errors == ['gone'])
    line.broken = False
    schedule(loop, script)
    assert line.written.get(timeout=LONG) == b'request'
    assert wait_for(lambda: script.errors == ['gone', ''])


def test_nothing_is_written_while_the_lock_is_held(running):
    """A port that blocks must not block the thread that reads."""
    line, script, loop = running
    writing, proceed = threading.Event(), threading.Event()

    def block(_data, _wait=True):
        writing.set()
        proceed.wait(LONG)

    line.write = block
    schedule(loop, script)
    assert writing.wait(LONG)
    assert loop.lock.acquire(timeout=LONG)
    loop.lock.release()
    proceed.set()


def test_without_a_scheduler_nothing_is_due(running):
    """A scheduler may come and go."""
    line, script, loop = running
    with loop.lock:
        loop.scheduler = None
    loop.send_due()
    with loop.lock:
        loop.scheduler = script
    schedule(loop, script)
    assert line.written.get(timeout=LONG) == b'request'


def test_it_stops_at_once_if_it_was_stopped_before_it_ran():
    """No thread is left behind."""
    loop = RequestLoop(Line(), Script())
    loop.stop()
    loop.run()
