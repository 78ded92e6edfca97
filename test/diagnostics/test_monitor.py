# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the tasks together, and of the self-test."""

from bahrs_driver.diagnostics.monitor import Monitor
from bahrs_driver.diagnostics.self_test import answer
from bahrs_driver.diagnostics.task import ERROR, OK, Verdict, WARN
from diagnostic_msgs.srv import SelfTest
import pytest


class Told:
    """A task that says what the test wants."""

    def __init__(self, name, level=OK):
        """Begin with a level."""
        self.name, self.level = name, level

    def judge(self, now):
        """Say it."""
        return Verdict(self.level, f'at {now}')

    def values(self, now):
        """Show the time."""
        return {'now': str(now)}


def test_statuses():
    """Names, levels, values, and whose they are."""
    monitor = Monitor([Told('Link'), Told('Rates', WARN)], 'bahrs_driver', lambda: 'OSS-1',
                      lambda: 7.0)
    first, second = monitor.statuses()
    assert (first.name, first.level, first.message) == ('bahrs_driver: Link', OK, 'at 7.0')
    assert (second.name, second.level) == ('bahrs_driver: Rates', WARN)
    assert [(pair.key, pair.value) for pair in second.values] == [('now', '7.0')]
    assert first.hardware_id == monitor.hardware_id == 'OSS-1'


def test_a_level_has_changed_until_it_was_told():
    """So that it can go out at once, and once."""
    task = Told('Link')
    monitor = Monitor([task], 'bahrs_driver', lambda: '')
    assert monitor.level_changed()
    monitor.statuses()
    assert not monitor.level_changed()
    task.level = ERROR
    assert monitor.level_changed()
    monitor.statuses()
    assert not monitor.level_changed()


def test_self_test_passes_when_every_test_does():
    """Its id is that of the hardware, its tests are the tasks that can fail."""
    verdicts = {'Link': Verdict(OK, 'open'), 'Framing': Verdict(OK, 'intact'),
                'Rates': Verdict(OK, 'right'), 'Integrity': Verdict(OK, 'safe'),
                'Publishing': Verdict(OK, 'yes')}
    response = answer(verdicts, 'OSS-1', SelfTest.Response())
    assert response.passed == b'\x01' and response.id == 'OSS-1'
    assert [status.name for status in response.status] == [
        'Port open and bytes flowing', 'Frames valid', 'Rates right', 'Integrity safe']
    verdicts['Integrity'] = Verdict(WARN, 'roll integrity risk')
    response = answer(verdicts, 'OSS-1', SelfTest.Response())
    assert response.passed == b'\x00'
    assert response.status[3].message == 'roll integrity risk'


@pytest.mark.parametrize('task', ['Requests', 'Device'])
def test_self_test_fails_where_answers_are_missing_or_cannot_be_read(task):
    """A device that is asked may be fine on the line, and still nothing be published."""
    verdicts = dict.fromkeys(('Link', 'Framing', 'Rates', 'Time', 'Requests', 'Device'),
                             Verdict(OK, 'fine'))
    assert answer(verdicts, '', SelfTest.Response()).passed == b'\x01'
    verdicts[task] = Verdict(WARN, 'not fine')
    response = answer(verdicts, '', SelfTest.Response())
    assert response.passed == b'\x00'
    assert [status.message for status in response.status if status.level != OK] == ['not fine']
