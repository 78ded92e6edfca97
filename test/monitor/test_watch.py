# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the statistics and the subscriptions of the monitor."""

from bahrs_driver.monitor import topic_stats, watch
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import pytest
import rclpy
from rclpy.context import Context
from sensor_msgs.msg import Imu
from std_msgs.msg import Float64
from support.waiting import wait_for

BACKLOG = 100           # messages waiting on each topic


@pytest.fixture
def node():
    """Return a node in a context of its own."""
    context = Context()
    rclpy.init(context=context)
    yield rclpy.create_node('watched', context=context)
    rclpy.shutdown(context=context)


def test_memory_is_bounded(monkeypatch):
    """Only arrivals of the window are kept, even if the rate is never read."""
    now = [0.0]
    monkeypatch.setattr(topic_stats.time, 'monotonic', lambda: now[0])
    stats = topic_stats.TopicStats()
    for _ in range(10_000):
        now[0] += 0.01
        stats.add(b'message')
    assert len(stats._arrivals) <= topic_stats.RATE_WINDOW / 0.01 + 1
    assert stats.count == 10_000
    assert abs(stats.rate() - 100.0) < 1e-6


def test_two_messages_at_the_same_time(monkeypatch):
    """The rate is 0 rather than infinite."""
    monkeypatch.setattr(topic_stats.time, 'monotonic', lambda: 1.0)
    stats = topic_stats.TopicStats()
    stats.add(b'')
    stats.add(b'')
    assert stats.rate() == 0.0


def test_every_topic_is_served_on_a_busy_host(node):
    """If messages wait on several topics, none of the topics is left out."""
    watched = watch.Watch(node)
    published = [('imu/data_raw', Imu()), ('heading', Float64()), ('/diagnostics', DiagnosticArray(
        status=[DiagnosticStatus(name='bahrs_driver: Link')]))]
    publishers = [(node.create_publisher(type(message), topic, BACKLOG), message)
                  for topic, message in published]
    assert wait_for(lambda: all(publisher.get_subscription_count()
                                for publisher, _ in publishers))
    for publisher, message in publishers:
        for _ in range(BACKLOG):
            publisher.publish(message)
    stats = watched.stats
    assert wait_for(lambda: watched.spin(0.001) or stats['imu/data_raw'].count >= BACKLOG / 2)
    assert stats['heading'].count > BACKLOG / 5 and watched.health.tasks
