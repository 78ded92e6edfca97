# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the recorder with publishers of this process."""

from bahrs_driver.recording.recorder import Recorder
from processes import wait_for
import pytest
import rclpy
from std_msgs.msg import String

EARLIER = 50        # messages of one publisher before anybody listened


def test_several_publishers_of_a_topic_lose_nothing():
    """Each counts its own messages, so their numbers do not follow on each other."""
    rclpy.init(args=[])
    try:
        publishers = [rclpy.create_node(name).create_publisher(String, '/shared_by_two', 100)
                      for name in ('first_of_two', 'second_of_two')]
        for _ in range(EARLIER):
            publishers[1].publish(String())
        recorder = Recorder('first_of_two', '', False, pytest.fail)
        recorder.start()
        try:
            assert wait_for(lambda: all(publisher.get_subscription_count()
                                        for publisher in publishers), 60)
            came = []
            for _ in range(10):
                for publisher in publishers:
                    publisher.publish(String())
            assert wait_for(lambda: came.extend(
                item for item in recorder.drain() if item.topic == '/shared_by_two')
                or len(came) == 20, 60)
        finally:
            recorder.stop()
        assert recorder.lost == 0
    finally:
        rclpy.try_shutdown()
