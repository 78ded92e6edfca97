# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""No clock that can be set stops the diagnostics or keeps the node from ending."""

import contextlib
import signal
import time

from bahrs_driver.convert.bahrs.converter import TOPICS
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rosgraph_msgs.msg import Clock
from support.devices import call, client_of, Device, DIAGNOSTICS, says
from support.processes import driver, listening, PATIENCE, wait_for
from support.random_starts import random_starts
from support.set_clock import SettableClock

SET_PARAMETERS = '/bahrs_driver/set_parameters'
HOUR = 3600.0
HERE = 60.0             # s from the present that is the host's time, not that of a simulation


def seconds(message):
    """Return the stamp of a message in seconds."""
    return message.header.stamp.sec + message.header.stamp.nanosec * 1e-9


def goes_on(ear, topic='/diagnostics', count=3):
    """Wait for more messages, and return them."""
    seen = len(ear.messages[topic])
    return ear.wait(topic, seen + count)[seen:]


def set_parameter(ear, name, value):
    """Set a parameter of the node and return the result."""
    request = SetParameters.Request(parameters=[Parameter(name=name, value=value)])
    return call(ear, SetParameters, SET_PARAMETERS, request).results[0]


@contextlib.contextmanager
def clock_topic(ear, period):
    """Publish simulated time, from 100 s on."""
    publisher = ear.node.create_publisher(Clock, '/clock', 10)
    now = Clock()
    now.clock.sec = 100

    def tick():
        now.clock.sec += 1
        publisher.publish(now)

    timer = ear.node.create_timer(period, tick)
    try:
        yield timer
    finally:
        ear.node.destroy_timer(timer)


@pytest.mark.parametrize('clock', ['none', 'runs', 'stops'])
def test_simulated_time(cable, clock):
    """Data and diagnostics have the time of the host, with one warning; a signal ends the node."""
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, contextlib.ExitStack() as stack:
        timer = clock != 'none' and stack.enter_context(clock_topic(ear, 0.05))
        with driver(cable.path, use_sim_time=True) as node:
            with Device(cable):
                ear.wait('imu/data')
                if clock == 'stops':
                    timer.cancel()
                for message in (*goes_on(ear), *goes_on(ear, 'imu/data')):
                    assert abs(seconds(message) - time.time()) < HERE
            assert says(ear, 'Link', DiagnosticStatus.ERROR, 'silent')
            begin = time.monotonic()
            assert node.end(signal.SIGTERM) == 0
            assert time.monotonic() - begin < PATIENCE / 10
            assert sum('use_sim_time has no effect' in line for line in node.lines) == 1


def test_simulated_time_cannot_be_set_at_run_time(cable):
    """The response has the reason; setting the present value changes nothing."""
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(cable.path) as node, Device(cable):
        for value, successful in ((True, False), (False, True)):
            result = set_parameter(ear, 'use_sim_time', ParameterValue(
                type=ParameterType.PARAMETER_BOOL, bool_value=value))
            assert result.successful == successful
            assert successful or 'do not follow /clock' in result.reason
        assert abs(seconds(goes_on(ear)[-1]) - time.time()) < HERE
        assert node.end() == 0


def test_a_parameter_of_an_undefined_type(cable):
    """The request fails, not the driver."""
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(cable.path) as node, Device(cable):
        request = SetParameters.Request(parameters=[Parameter(
            name='nvm.page', value=ParameterValue(type=77))])
        client_of(ear, SetParameters, SET_PARAMETERS).call_async(request)
        goes_on(ear)
        goes_on(ear, 'imu/data')
        result = set_parameter(ear, 'nvm.page', ParameterValue(
            type=ParameterType.PARAMETER_INTEGER, integer_value=7))
        assert result.successful
        assert 'Traceback' not in node.text
        assert node.end() == 0


def test_the_host_clock_is_set_back(cable, tmp_path):
    """Diagnostics continue with the new time, silence is reported, Ctrl-C ends the node."""
    clock = SettableClock(tmp_path)
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, clock.used(), driver(cable.path) as node:
        with Device(cable):
            ear.wait('imu/data', 10)
            clock.set_back(HOUR)
            assert abs(seconds(goes_on(ear)[-1]) - time.time() + HOUR) < HERE
            assert wait_for(lambda: abs(
                seconds(goes_on(ear, 'imu/data')[-1]) - time.time() + HOUR) < HERE)
        assert says(ear, 'Link', DiagnosticStatus.ERROR, 'silent')
        assert node.end() == 0
        assert 'Traceback' not in node.text


@pytest.mark.parametrize('kind', [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_after_the_host_clock_is_set_back(cable, tmp_path, kind):
    """They end the node, too, while data arrives and afterwards."""
    clock = SettableClock(tmp_path)
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, clock.used(), driver(cable.path) as node:
        with Device(cable):
            ear.wait('imu/data', 10)
            clock.set_back(HOUR)
            # The first message may have been under way before.
            assert wait_for(lambda: abs(
                seconds(goes_on(ear, count=1)[-1]) - time.time() + HOUR) < HERE)
            goes_on(ear, 'imu/data')
        assert node.end(kind) == 0
        assert 'Traceback' not in node.text


def test_the_host_clock_is_set_back_without_a_port(tmp_path):
    """Only the clock of the node could wake it."""
    clock = SettableClock(tmp_path)
    with listening(DIAGNOSTICS) as ear, clock.used(), driver(str(tmp_path / 'none')) as node:
        ear.wait('/diagnostics')
        clock.set_back(HOUR)
        goes_on(ear)
        assert node.end(signal.SIGTERM) == 0


@pytest.mark.slow
def test_signals_at_random_moments(tmp_path):
    """Status 0 and no traceback at any moment; `bench/exits.py` starts 300 nodes."""
    for each in random_starts(9, SettableClock(tmp_path), seed=4):
        assert each.status == 0 and 'Traceback' not in each.text, each
