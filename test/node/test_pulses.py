# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test sync pulses with node and emulator as processes, and a publisher of pulse times."""

import math
import time
from types import SimpleNamespace

from bahrs_driver.clock.estimation.pulses import PulseReference
from bahrs_driver.node.driver_node import DriverNode
from hypothesis import given, strategies as st
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import TimeReference
from support.devices import DIAGNOSTICS, status, StoppableThread
from support.processes import driver, listening, running, wait_for

SECOND = 10 ** 9
LEAD = 4_000_000      # ns; shows which source of pulse times the stamps follow


class PulsePublisher(StoppableThread):
    """Publishes the time of a pulse after each whole second, less LEAD."""

    def __init__(self, node, reliability):
        """Publish from a node."""
        super().__init__()
        self._publisher = node.create_publisher(
            TimeReference, 'pulses', QoSProfile(depth=10, reliability=reliability))

    def run(self):
        """Publish until the end."""
        published = time.time_ns() // SECOND
        while not self._ended.wait(0.02):
            if time.time_ns() // SECOND > published:
                published += 1
                message = TimeReference(source='test')
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(
                    published * SECOND - LEAD, SECOND)
                self._publisher.publish(message)


@given(seconds=st.integers(-2 ** 31, 2 ** 31 - 1), nanoseconds=st.integers(0, 2 ** 32 - 1))
def test_any_time_of_a_pulse_is_accepted(seconds, nanoseconds):
    """The time comes from another node, and may be invalid."""
    message = TimeReference()
    message.header.stamp.sec, message.header.stamp.nanosec = seconds, nanoseconds
    received = []
    clock = SimpleNamespace(pulse_reference=received.append)
    DriverNode._on_pulse_reference(SimpleNamespace(_parts=SimpleNamespace(clock=clock)), message)
    reference = PulseReference(SECOND, external=True)
    reference.add(*received)
    assert received == [seconds * SECOND + nanoseconds]
    assert reference.find(time.time_ns()) in (None, *received)


def delay_by_pulses(ear):
    """Return the delay by pulses in us; NaN until stamps follow them."""
    values = {pair.key: pair.value for pair in status(ear, 'Time').values} \
        if status(ear, 'Time') else {}
    delay = values.get('Least delay by pulses [us]', 'unknown')
    follows = values.get('Source in use') == 'sync_pulse' and delay != 'unknown'
    return float(delay) if follows else math.nan


@pytest.mark.parametrize('external, reliability', [
    (False, ReliabilityPolicy.RELIABLE), (True, ReliabilityPolicy.RELIABLE),
    (True, ReliabilityPolicy.BEST_EFFORT)])
def test_stamps_follow_pulses(tmp_path, external, reliability):
    """Pulses are at whole seconds of the host clock, or at times from a publisher."""
    link = str(tmp_path / 'port')
    words = {'time__sync_pulse__reference': 'pulses'} if external else {}
    with listening(DIAGNOSTICS) as ear, running(
            'bahrs', 'emulate', '--link', link, '--sync-pulse-rate', '1') as emulator:
        assert wait_for(lambda: emulator.lines)
        with PulsePublisher(ear.node, reliability), \
                driver(link, time__source='sync_pulse', **words):
            early = LEAD / 1000 if external else 0
            assert wait_for(lambda: -1000 < delay_by_pulses(ear) - early < 3000)


def test_the_subscription_can_be_overridden(tmp_path):
    """Like the quality of service of any publisher."""
    words = {'time__sync_pulse__reference': 'pulses', 'time__source': 'sync_pulse',
             'qos_overrides./pulses.subscription.reliability': 'reliable'}
    with listening(DIAGNOSTICS) as ear, driver(str(tmp_path / 'port'), **words) as node:
        assert wait_for(lambda: ear.node.count_subscribers('pulses'))
        info = ear.node.get_subscriptions_info_by_topic('pulses')[0]
        assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
        assert 'without effect' not in node.text
