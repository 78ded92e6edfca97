# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of publishing states, with a middleware made for them; the real one is in test/node."""

from functools import partial

from bahrs_driver.node.latched_publisher import BACKLOG, LatchedPublisher, PATIENCE
from hypothesis import given, strategies as st
import pytest


class Subscriber:
    """Receives at once unless it is stopped; afterwards only messages that the publisher kept."""

    def __init__(self):
        self.received, self.stopped = [], False


class Publisher:
    """A publisher with a history of a depth for stopped subscribers."""

    def __init__(self, depth, subscribers):
        self._depth, self.subscribers = depth, subscribers
        self.history, self.destroyed, self.missed = [], False, {}

    def publish(self, message):
        """Send a message to running subscribers, and keep it."""
        assert not self.destroyed
        self.history = [*self.history, message][-self._depth:]
        for subscriber in self.subscribers:
            if subscriber.stopped:
                self.missed.setdefault(subscriber, []).append(message)
            else:
                subscriber.received.append(message)

    def wait_for_all_acked(self, timeout):
        """Return whether no subscriber has missed a message."""
        assert timeout.nanoseconds == 0
        return not self.missed

    def deliver(self):
        """Send missed messages that are kept to subscribers that run again."""
        for subscriber in [one for one in self.missed if not one.stopped]:
            missed = self.missed.pop(subscriber)
            subscriber.received += [message for message in missed if message in self.history]


class Middleware:
    """A topic, its publishers, and the one under test."""

    def __init__(self, subscribers=1, **options):
        self.now = 0.0
        self.subscribers = [Subscriber() for _ in range(subscribers)]
        self.publishers = []
        self.latched = LatchedPublisher(
            self.create(1), lambda: self.create(BACKLOG), self.destroy,
            clock=lambda: self.now, **options)
        self.count = 0

    def create(self, depth):
        """Return another publisher of the topic."""
        self.publishers.append(Publisher(depth, self.subscribers))
        return self.publishers[-1]

    def destroy(self, publisher):
        """Remove a publisher."""
        publisher.destroyed = True
        self.publishers.remove(publisher)

    def change(self):
        """Publish the next state, a number."""
        self.latched.publish(self.count)
        self.count += 1

    def pass_time(self, seconds=2 * PATIENCE):
        """Let time pass, with the calls of the node."""
        self.now += seconds
        for publisher in self.publishers:
            publisher.deliver()
        self.latched.flush()
        self.latched.supervise()

    def set_stopped(self, number, stopped):
        """Stop or continue a subscriber."""
        self.subscribers[number].stopped = stopped

    def late_joiner(self):
        """Return the messages for a subscriber that starts now."""
        return [message for publisher in self.publishers for message in publisher.history]


def test_a_late_joiner_gets_the_present_state_only():
    """A live subscriber receives every change, from one publisher."""
    topic = Middleware()
    for _ in range(5):
        topic.change()
        assert topic.late_joiner() == [topic.count - 1]
    assert topic.subscribers[0].received == [0, 1, 2, 3, 4]
    assert len(topic.publishers) == 1


def test_a_change_waits_until_the_one_before_is_acknowledged():
    """For a moment, without a second publisher."""
    topic = Middleware()
    subscriber, = topic.subscribers
    subscriber.stopped = True
    topic.change()
    topic.change()
    assert topic.late_joiner() == [0]
    subscriber.stopped = False
    topic.pass_time(PATIENCE / 2)
    assert subscriber.received == [0, 1] and topic.late_joiner() == [1]
    assert len(topic.publishers) == 1


def test_a_subscriber_that_is_stopped_loses_nothing_and_holds_up_nobody():
    """Missed states are kept in order; afterwards a late subscriber receives the latest alone."""
    topic = Middleware(subscribers=2)
    stopped, running = topic.subscribers
    topic.change()
    stopped.stopped = True
    for _ in range(10):
        topic.change()
        topic.pass_time()
        assert running.received[-1] == topic.count - 1
    assert running.received == list(range(11)) and stopped.received == [0]
    stopped.stopped = False
    topic.pass_time()
    # The present state once more, for late joiners.
    assert stopped.received == running.received == [*range(11), 10]
    assert topic.late_joiner() == [10] and len(topic.publishers) == 1


def test_nothing_waits_without_end_if_it_is_not_supervised():
    """The stopped subscriber loses the oldest changes."""
    topic = Middleware(subscribers=2)
    stopped, running = topic.subscribers
    stopped.stopped = True
    for _ in range(1000):
        topic.change()
    assert len(topic.latched._waiting) <= BACKLOG
    assert running.received == list(range(1000 - BACKLOG))


@pytest.mark.parametrize('wait', [True, False])
def test_an_ordinary_publisher_on_request(wait):
    """With a history chosen by the user all changes are kept, and none waits."""
    topic = Middleware(wait=wait)
    topic.subscribers[0].stopped = True
    topic.change()
    topic.change()
    assert len(topic.late_joiner()) == 1
    assert topic.late_joiner() == ([0] if wait else [1])


EVENTS = {
    'change': Middleware.change,
    'time': Middleware.pass_time,
    **{f'{word} {number}': partial(Middleware.set_stopped, number=number, stopped=word == 'stop')
       for word in ('stop', 'go on') for number in (0, 1)}}


@given(st.lists(st.sampled_from(sorted(EVENTS)), max_size=BACKLOG))
def test_no_change_is_lost_and_the_last_message_is_the_present_state(events):
    """Any subscriber stops and continues at any time."""
    topic = Middleware(subscribers=2)
    for event in [*events, 'go on 0', 'go on 1', 'time', 'time', 'time']:
        EVENTS[event](topic)
    for subscriber in topic.subscribers:
        assert set(subscriber.received) == set(range(topic.count))
        assert not topic.count or subscriber.received[-1] == topic.count - 1
    assert topic.late_joiner() == [topic.count - 1] * bool(topic.count)
    assert len(topic.publishers) == 1
