# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The start of the node: nothing is missed by subscribers that were there before."""

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.convert.raw import TOPIC as RAW
from bahrs_driver.protocol.bahrs.messages import FORCE
import pytest
from sensor_msgs.msg import Imu
from std_msgs.msg import UInt8MultiArray
from support.devices import DEEP, Device
from support.processes import driver, listening, wait_for

WAITING = 'the port is opened when all topics have a subscriber'


def test_the_first_sample_reaches_every_subscriber(cable):
    """With startup.wait_for_subscribers, from the first frame on."""
    topics = {**TOPICS, RAW: UInt8MultiArray}
    with listening(topics) as ear, driver(
            cable.path, startup__wait_for_subscribers=60, publish__raw=True, **DEEP) as node:
        # Not as soon as the port is open: what was sent before is discarded while it is set up.
        assert wait_for(lambda: 'is open' in node.text)
        with Device(cable) as device:
            for topic, count in (('imu/data_raw', 50), ('heading', 1), (RAW, 1)):
                ear.wait(topic, count)
        first = ear.messages['imu/data_raw'][0]
        # The force along x is the number of the message.
        assert first.linear_acceleration.x == pytest.approx(0.0, abs=FORCE / 2)
        assert len(ear.messages['imu/data_raw']) <= len(device.inertial)
        assert WAITING in node.text


def test_a_topic_without_a_subscriber(cable):
    """The wait has a limit, and the warning names the topics."""
    with listening({'imu/data': Imu}) as ear, Device(cable), \
            driver(cable.path, startup__wait_for_subscribers=0.5) as node:
        ear.wait('imu/data')
        warning = next(line for line in node.lines if 'no subscriber within 0.5 s' in line)
        assert 'imu/mag' in warning


def test_a_signal_while_it_waits(cable):
    """The node ends at once."""
    with driver(cable.path, startup__wait_for_subscribers=60) as node:
        assert wait_for(lambda: WAITING in node.text)
        assert node.end() == 0
