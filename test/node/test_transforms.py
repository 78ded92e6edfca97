# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the publishers of transforms, with a middleware made for them, and of the node."""

from importlib.util import find_spec
import sys
from types import ModuleType

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.node.transforms import Transforms
from bahrs_driver.ros_layout import message_objects
import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from support.devices import Device
from support.processes import listening, running

MOUNTED = {'publish.static_tf': True, 'mounting.x': 1.5, 'mounting.yaw': 3.141592653589793}


def settings(**given):
    """Return the settings of a BAHRS with some parameters."""
    table = parameter_table()
    return table.settings(table.values(given))[1]


class FakePublisher:
    """Keeps the messages."""

    def __init__(self, kind, topic, profile=None):
        self.kind, self.topic, self.profile, self.messages = kind, topic, profile, []

    def publish(self, message):
        """Keep a message."""
        assert isinstance(message, self.kind)
        self.messages.append(message)


class FakeTFMessage:
    """Has the field of tf2_msgs/TFMessage."""

    def __init__(self):
        self.transforms = []


@pytest.fixture
def tf2_msgs(monkeypatch):
    """Install a package with this message."""
    module = ModuleType('tf2_msgs.msg')
    module.TFMessage = FakeTFMessage
    monkeypatch.setitem(sys.modules, 'tf2_msgs', ModuleType('tf2_msgs'))
    monkeypatch.setitem(sys.modules, 'tf2_msgs.msg', module)
    message_class = message_objects._message_class
    message_class.cache_clear()
    yield
    message_class.cache_clear()


def published(given):
    """Return the transforms for some parameters, and their publishers by topic."""
    publishers = {}

    def create(kind, topic, profile=None):
        return publishers.setdefault(topic, FakePublisher(kind, topic, profile))

    return Transforms(settings(**given), create), publishers


def test_the_mounting_is_published_once(tf2_msgs):
    """For late subscribers, too, as tf2_ros publishes it."""
    transforms, publishers = published(MOUNTED)
    (publisher,) = publishers.values()
    assert publisher.topic == '/tf_static' and not transforms.warnings
    profile = publisher.profile
    assert (profile.depth, profile.durability, profile.reliability) == (
        1, DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE)
    (message,) = publisher.messages
    (transform,) = message.transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ('base_link', 'imu_link')
    assert transform.transform.translation.x == 1.5
    assert transform.transform.rotation.z == pytest.approx(1.0)
    assert transforms.attitude is None


def test_the_child_is_the_frame_of_the_device(tf2_msgs):
    """Also if it is a default that depends on the convention."""
    _, publishers = published({'publish.static_tf': True, 'frame_convention': 'ned'})
    (transform,) = publishers['/tf_static'].messages[0].transforms
    assert transform.child_frame_id == 'imu_link_ned'
    assert transform.transform.rotation.x == 1.0        # z points down


def test_the_attitude_has_a_publisher(tf2_msgs):
    """With the quality of service of the other topics, as in tf2_ros."""
    transforms, publishers = published({'publish.tf': True})
    assert publishers == {'/tf': transforms.attitude}
    assert transforms.attitude.profile is None and not transforms.attitude.messages


def test_no_publishers_unless_asked_for(tf2_msgs):
    """Others may publish these transforms."""
    transforms, publishers = published({})
    assert not publishers and transforms.attitude is None and not transforms.warnings


@pytest.mark.skipif(bool(find_spec('tf2_msgs')), reason='tf2_msgs is installed')
def test_without_tf2_msgs_the_node_says_so(cable):
    """And publishes everything else."""
    with listening(TOPICS) as ear, running(
            'driver_node', '--ros-args', '-p', f'port:={cable.path}', '-p', 'publish.tf:=true',
            '-p', 'publish.static_tf:=true') as node, Device(cable):
        ear.wait('imu/data')
        for name in ('publish.tf', 'publish.static_tf'):
            assert node.text.count(
                f'parameter {name} is true: transforms are not published, because the ROS package '
                f'tf2_msgs is not installed: install it (ros-jazzy-tf2-msgs) or set {name} to '
                'false') == 1


def test_a_late_subscriber_receives_the_mounting():
    """With the middleware, where tf2_msgs is installed."""
    kind = pytest.importorskip('tf2_msgs.msg', reason='tf2_msgs is not installed').TFMessage
    received, context = [], Context()
    context.init()
    node = Node('transforms', context=context)
    try:
        kept = Transforms(settings(**MOUNTED), node.create_publisher)
        node.create_subscription(kind, '/tf_static', received.append, QoSProfile(
            depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        while not received:
            executor.spin_once()
        assert received[0].transforms[0].transform.translation.x == 1.5
        assert not kept.warnings
    finally:
        node.destroy_node()
        context.try_shutdown()
