# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of verbs that are ROS nodes, with a host clock that is set back."""

import signal

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.processes import driver, listening, running, wait_for
from support.set_clock import SettableClock

HOUR = 3600.0           # s


@pytest.mark.parametrize('kind', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('verb', ['record', 'monitor'])
def test_verbs_end_after_the_host_clock_is_set_back(tmp_path, verb, kind):
    """Destroying a node then hangs in the middleware; the verb ends nevertheless."""
    clock = SettableClock(tmp_path)
    words = {'record': ['-o', str(tmp_path / 'bag')], 'monitor': ['--json']}[verb]
    with PtyPort() as port, Device(port), listening(TOPICS) as ear, driver(port.path), \
            clock.used(), running('bahrs', verb, *words) as process:
        ear.wait('imu/data', 10)
        assert wait_for(lambda: ear.node.count_subscribers('imu/data') >= 2)
        seen = len(ear.messages['imu/data'])
        clock.set_back(HOUR)
        ear.wait('imu/data', seen + 100)
        assert process.end(kind) in (0, 130)
        assert 'Traceback' not in process.text and 'imu/data' in process.text
