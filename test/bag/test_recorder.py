# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the recorder with publishers of this process."""

import contextlib
import time

from bahrs_driver.bag import recorder as recorder_module, topic_search
from bahrs_driver.bag.recorder import Recorder
from bahrs_driver.ros.node_names import ROOT, Selection
import pytest
import rclpy
from rclpy.context import Context
from std_msgs.msg import String, UInt8MultiArray
from support.waiting import wait_for

EARLIER = 50        # messages of a publisher without subscribers
LATER = 20          # messages once there is one
PERIOD = 0.02       # s from one to the next


@pytest.fixture(autouse=True)
def ros():
    """Initialize ROS for a test."""
    rclpy.init(args=[])
    yield
    rclpy.try_shutdown()


@contextlib.contextmanager
def recording(name):
    """Yield a running recorder of a node, and a function that waits for a number of messages."""
    recorder, came = Recorder(Selection(name, ROOT), False, pytest.fail), []
    recorder.start()
    try:
        yield recorder, lambda count: wait_for(
            lambda: came.extend(recorder.drain()) or len(came) >= count) and came
    finally:
        recorder.stop()


@contextlib.contextmanager
def publishing(name, kind=String, topic='~/topic'):
    """Yield a publisher in its own DDS participant, which must be discovered."""
    context = Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node(name, context=context)
    try:
        yield node.create_publisher(kind, topic, 1000)
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


def publish(publisher, count):
    """Publish messages one after the other."""
    for _ in range(count):
        publisher.publish(publisher.msg_type())
        time.sleep(PERIOD)


def test_a_topic_with_several_publishers_shows_no_losses():
    """Each publisher counts its own messages, so sequence numbers are not continuous."""
    publishers = [rclpy.create_node(name).create_publisher(String, '/shared_by_two', 100)
                  for name in ('first_of_two', 'second_of_two')]
    for _ in range(EARLIER):
        publishers[1].publish(String())
    with recording('first_of_two') as (recorder, came):
        assert wait_for(lambda: all(publisher.get_subscription_count()
                                    for publisher in publishers))
        for _ in range(10):
            for publisher in publishers:
                publisher.publish(String())
        assert wait_for(lambda: sum(item.topic == '/shared_by_two' for item in came(1)) == 20)
    assert recorder.lost == 0 and recorder.missed == {}


def test_a_driver_that_is_started_after_the_recorder(monkeypatch):
    """Messages before discovery are counted as missed."""
    monkeypatch.setattr(topic_search, 'DISCOVERY', 0.0)      # else its rate decides
    with recording('late') as (recorder, came), publishing('late') as publisher:
        publish(publisher, 1)
        while not publisher.get_subscription_count():
            publish(publisher, 1)
        publish(publisher, LATER)
        assert came(LATER)
        first = recorder._counts['/late/topic'].before_first
        assert recorder.missed['/late/topic'] == first > 0 and recorder.lost == 0


def test_a_driver_that_ran_before_the_recorder():
    """Recording begins at discovery: no message is missed."""
    with publishing('early') as publisher:
        for _ in range(100 * EARLIER):
            publisher.publish(String())
        with recording('early') as (recorder, came):
            assert wait_for(publisher.get_subscription_count)
            publish(publisher, LATER)
            came(LATER)
            assert recorder.missed == {} and recorder.lost == 0


def test_a_driver_that_is_restarted():
    """Its publishers count from 1, and its messages before discovery are missed."""
    with recording('again') as (recorder, came):
        with publishing('again') as publisher:
            assert wait_for(publisher.get_subscription_count)
            publish(publisher, LATER)
            came(LATER)
        assert wait_for(lambda: not recorder._node.count_publishers('/again/topic'))
        with publishing('again') as publisher:
            publish(publisher, 3)
            assert wait_for(publisher.get_subscription_count)
            publish(publisher, LATER)
            assert wait_for(lambda: recorder.missed.get('/again/topic', 0) + sum(
                item.topic == '/again/topic' for item in came(1)) == 3 + 2 * LATER)


def test_raw_message_without_a_label():
    """Its log time is its arrival."""
    with publishing('foreign', UInt8MultiArray, '/foreign/raw') as publisher, \
            recording('foreign') as (recorder, came):
        assert wait_for(publisher.get_subscription_count)
        publish(publisher, 1)
        item, = [item for item in came(1) if item.topic == '/foreign/raw']
        assert 0 <= recorder.advance_watermark() + 10 ** 9 - item.log_time


def test_a_type_that_is_not_installed(monkeypatch):
    """The topic is left out with a note, and the others are recorded."""
    def find(name):
        if name.startswith('std_msgs'):
            raise ModuleNotFoundError(name)
        return __import__(name, fromlist=['msg'])

    monkeypatch.setattr(recorder_module, 'import_module', find)
    with publishing('odd'), recording('odd') as (recorder, _):
        assert wait_for(lambda: recorder.notes)
    assert recorder.notes == ['/odd/topic is left out: its type std_msgs/msg/String is not '
                              'installed here']
