# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Faults of the driver itself, in the real node: the data goes on."""

import contextlib
import sys

from bahrs_driver.convert.bahrs.converter import TOPICS
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from support.devices import Device, DIAGNOSTICS, says, status
from support.processes import listening, Process, wait_for

# What goes wrong, as lines of Python that are run before the node: the name that it defines
# fails again and again, once all is under way.
START = """
import sys
from bahrs_driver.node import main as driver_node
{imports}
original, calls = {name}, [0]
def failing(*arguments):
    calls[0] += 1
    if calls[0] > {first} and calls[0] % {every} == 0:
        raise {error}
    return original(*arguments)
{name} = failing
sys.exit(driver_node.main())
"""
PLACES = {
    'decoding': ('from bahrs_driver.protocol.bahrs.frames import BahrsCodec', 'BahrsCodec.decode',
                 'KeyError(17)'),
    'converting': ('from bahrs_driver.convert.bahrs.converter import BahrsConverter',
                   'BahrsConverter.convert', 'OverflowError("too large")'),
    'stamping': ('from bahrs_driver.clock import SampleClock', 'SampleClock.stamp',
                 'ZeroDivisionError()'),
    'publishing': ('from rclpy.publisher import Publisher', 'Publisher.publish',
                   'RuntimeError("\\x1b[2J no memory")'),
    'watching the clock': ('from bahrs_driver.clock import SampleClock', 'SampleClock.state',
                           'KeyError(3)'),
    'watching': ('from bahrs_driver.devices.bahrs.health import BahrsHealth',
                 'BahrsHealth.observe', 'StopIteration()'),
}


@contextlib.contextmanager
def failing_driver(port, place):
    """Run a node in which one function fails repeatedly after the start."""
    imports, name, error = PLACES[place]
    every = 2 if place == 'watching the clock' else 7       # that is called 5 times a second
    first = 999 if place == 'publishing' else 9     # after the events of parameters
    code = START.format(imports=imports, name=name, error=error, every=every, first=first)
    node = Process([sys.executable, '-c', code, '--ros-args', '-p', f'port:={port}'])
    try:
        yield node
    finally:
        node.end()


@pytest.mark.parametrize('place', PLACES)
def test_the_data_goes_on(cable, place):
    """Only failed messages are missing; the log has a line per kind, and diagnostics count."""
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, failing_driver(cable.path, place) as node, \
            Device(cable):
        ear.wait('imu/data_raw', 100)
        assert says(ear, 'Publishing', DiagnosticStatus.WARN, 'Fault of the driver: ')
        assert wait_for(lambda: any(int(pair.value) > 10 for pair in
                                    status(ear, 'Publishing').values
                                    if pair.key == 'Faults of the driver'))
        assert len(node.lines) < 20 and 'failed: ' in node.text
        assert 'Traceback' not in node.text and '\x1b[2J' not in node.text
        assert node.end() == 0
