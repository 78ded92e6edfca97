# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the checks of drivers and their subscribers."""

import contextlib

from bahrs_driver.devices.driver_graph import find_drivers
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.graph import check
from bahrs_driver.ros_layout.message_objects import message_type
from diagnostic_msgs.srv import SelfTest
import pytest
import rclpy
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import FluidPressure, Imu
from support.processes import running, wait_for


@contextlib.contextmanager
def create_node(name):
    """Create a node in its own context, and destroy both at the end."""
    context = Context()
    rclpy.init(context=context)
    node = rclpy.create_node(name, context=context, namespace='/made_up')
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


@pytest.fixture
def node():
    """Return a node in its own context."""
    with create_node('patient') as node:
        yield node


def results(node, publishers, subscribers):
    """Return the results by check, after discovery of these numbers of endpoints."""
    def known(endpoints):
        return sum(info.node_name in ('patient', 'other') for info in endpoints)

    topic = '/made_up/imu/data'
    assert wait_for(lambda: known(node.get_publishers_info_by_topic(topic)) == publishers
                    and known(node.get_subscriptions_info_by_topic(topic)) == subscribers, 60)
    return {result.check: result for result in check(node, '/dev/ttyUSB7', 0.0)}


def test_no_driver(node):
    """The command starts a driver on the port."""
    result = results(node, 0, 0)['driver']
    assert 'no driver runs' in result.message
    assert result.command.endswith('port:=/dev/ttyUSB7')


def test_a_compatible_subscriber(node):
    """No problem is reported."""
    node.create_publisher(Imu, 'imu/data', 100)
    node.create_subscription(Imu, 'imu/data', lambda message: None, 10)
    found = results(node, 1, 1)
    assert found['driver'].message == 'other nodes publish 1 topics of a driver'
    assert found['subscribers'].level is Level.OK


def test_a_subscriber_with_incompatible_qos(node):
    """The command sets the QoS parameter of the driver."""
    node.create_publisher(Imu, 'imu/data', 100)
    node.create_subscription(Imu, 'imu/data', lambda message: None, QoSProfile(
        depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    result = results(node, 1, 1)['subscribers']
    assert result.level is Level.PROBLEM
    assert 'requests durability transient_local, the driver offers volatile' in result.message
    assert result.command.endswith(
        '-p qos_overrides./made_up/imu/data.publisher.durability:=transient_local')


def test_a_subscriber_of_another_type(node):
    """The message names the subscriber and its type."""
    node.create_publisher(Imu, 'imu/data', 100)
    with create_node('other') as other:       # one context cannot have both types
        other.create_subscription(FluidPressure, 'imu/data', lambda message: None, 10)
        result = results(node, 1, 1)['subscribers']
    assert result.level is Level.PROBLEM
    assert '/made_up/other subscribes to /made_up/imu/data as sensor_msgs/msg/FluidPressure' \
        in result.message


def test_two_publishers_of_one_topic(node):
    """It is a problem."""
    node.create_publisher(Imu, 'imu/data', 100)
    node.create_publisher(Imu, 'imu/data', 100)
    result = results(node, 2, 0)['publishers']
    assert result.level is Level.PROBLEM and 'both publish' in result.message


def test_transforms_of_several_nodes(node):
    """Every node with a transform publishes it on the same topic."""
    for topic, kind in DEVICES['bahrs'].topics().items():
        node.create_publisher(message_type(kind), topic, 10)
    node.create_service(SelfTest, 'self_test', lambda request, response: response)
    with create_node('other') as other:
        for either in node, other:
            either.create_publisher(Imu, '/tf', 10)
        assert wait_for(lambda: len(node.get_publishers_info_by_topic('/tf')) == 2, 60)
        found = {result.check: result for result in check(node, '/dev/ttyUSB7', 0.0)}
    assert found['driver'].message.startswith('/made_up/patient publishes ')
    assert 'publishers' not in found and found['subscribers'].level is Level.OK


def test_a_driver_in_another_namespace(node):
    """The doctor does not suggest to start another driver."""
    with running('driver_node', '--ros-args', '-p', 'port:=/nowhere', '-r', '__ns:=/left',
                 '-r', '__node:=front'):
        assert wait_for(lambda: '/left/front' in find_drivers(node), 60)
        found = list(check(node, '/dev/ttyUSB7', 0.0))
        (driver,) = (result for result in found if result.check == 'driver')
        assert driver.level is Level.OK
        assert driver.message.startswith('/left/front publishes ')
        assert not any('driver_node' in result.command for result in found)
        (health,) = (result for result in found if result.check == 'health')
        assert health.level is Level.PROBLEM
        assert health.message.startswith('/left/front reports: Link: /nowhere does not exist')
        assert health.command == 'bahrs monitor --node /left/front'
        (driver,) = check(node, '/dev/ttyUSB7', 0.0, namespace='/right')
        assert driver.message == ('no driver runs in namespace /right, but /left/front '
                                  'elsewhere')
        assert driver.command == 'bahrs monitor --node /left/front'


def test_two_drivers_with_one_name(node):
    """Their diagnostics cannot be distinguished."""
    with contextlib.ExitStack() as stack:
        for _ in range(2):
            stack.enter_context(running('driver_node', '--ros-args', '-p', 'port:=/nowhere',
                                        '-r', '__ns:=/left'))
        sentence = ('2 nodes are named /left/bahrs_driver: their diagnostics cannot be '
                    'distinguished')
        assert wait_for(lambda: sentence in [
            result.message for result in check(node, '/dev/ttyUSB7', 0.0)])
