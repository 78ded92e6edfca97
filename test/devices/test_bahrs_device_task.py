# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the diagnostics task *Device* of a BAHRS."""

from dataclasses import replace

from bahrs_driver.devices.bahrs.device_task import DeviceTask
from bahrs_driver.diagnostics.task import OK, WARN
from bahrs_driver.protocol.bahrs.messages import HardwareVersion, Navigation, SoftwareVersion
from bahrs_driver.protocol.integrity import Integrity
from support.tasks import summary_of, values_of

SAFE, GONE = Integrity.SAFE, Integrity.UNAVAILABLE
NAVIGATION = Navigation(0, 500.0, 0.0, 0.0, 0.0, 0.0, (SAFE,) * 5)


def test_identifier_and_versions():
    """The identifier needs the unique number; versions are shown as received."""
    task = DeviceTask(lambda now: False)
    assert task.device_id == '' and 'only at power-on' in summary_of(task, 0.0).message
    task.observe(SoftwareVersion('OSS', 2, 7))
    assert task.device_id == '' and summary_of(task, 0.0) == (OK, 'OSS 2.7')
    task.observe(HardwareVersion(0x450, (1, 2, 0xABCDEF01)))
    assert task.device_id == 'OSS-0000000100000002ABCDEF01'
    assert values_of(task, 0.0) == {
        'Device id': 'OSS-0000000100000002ABCDEF01', 'Software version': 'OSS 2.7',
        'MCU': '0x0450', 'MCU unique number': '0000000100000002ABCDEF01', 'NVM session': 'none'}


def test_an_impossible_height_names_the_parameter():
    """The warning lasts as long as the height does, if the height is available."""
    task, low = DeviceTask(lambda now: False), replace(NAVIGATION, pressure_height=-5812.0)
    task.observe(replace(low, health=(GONE,) + (SAFE,) * 4))
    assert summary_of(task, 0.0).level == OK
    task.observe(low)
    assert summary_of(task, 0.0).level == WARN
    assert 'pressure_height.format' in summary_of(task, 0.0).message
    task.observe(NAVIGATION)
    assert summary_of(task, 0.0).level == OK
