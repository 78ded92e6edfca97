# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the updater and of the self-test."""

from bahrs_driver.diagnostics.self_test import answer
from bahrs_driver.diagnostics.task import ERROR, OK, Summary, Template, WARN
from bahrs_driver.diagnostics.updater import MIN_INTERVAL, Updater
from diagnostic_msgs.srv import SelfTest
from hypothesis import given, strategies as st
import pytest


class StubTask:
    """A task with a given level and message, by default the time."""

    def __init__(self, name, level=OK, message='at {now}'):
        self.name, self.level, self.message = name, level, message
        self.collected = 0

    def run(self, status):
        """Report level, message and the time."""
        status.values_from(self._values)
        return status.summary(Template(self.level, self.message), now=status.now)

    def _values(self, now):
        self.collected += 1
        return {'now': str(now)}


def test_content_of_statuses():
    """They have names, levels, values and the hardware id."""
    updater = Updater([StubTask('Link'), StubTask('Rates', WARN)], 'bahrs_driver', '/dev/ttyUSB0',
                      lambda: 7.0)
    first, second = updater.statuses()
    assert (first.name, first.level, first.message) == ('bahrs_driver: Link', OK, 'at 7.0')
    assert (second.name, second.level) == ('bahrs_driver: Rates', WARN)
    assert [(pair.key, pair.value) for pair in second.values] == [('now', '7.0')]
    assert first.hardware_id == '/dev/ttyUSB0'


class Clock:
    """A clock that the test sets."""

    def __init__(self):
        """Begin late enough for a report."""
        self.now = 100.0

    def __call__(self):
        """Return the time in seconds."""
        return self.now


@pytest.fixture
def clock():
    """Return a clock."""
    return Clock()


@pytest.mark.parametrize('level, message', [
    (ERROR, 'roll unavailable'), (WARN, 'roll, pitch integrity risk'), (WARN, '')])
def test_a_change_is_due_until_it_is_reported(clock, level, message):
    """A changed message is enough."""
    task = StubTask('Integrity', WARN, 'roll integrity risk')
    updater = Updater([StubTask('Link', OK, 'open'), task], 'bahrs_driver', '', clock)
    assert updater.change_due()
    updater.statuses()
    clock.now += 1.0
    assert not updater.change_due()
    assert task.collected == 1, 'values are formatted for a report only'
    task.level, task.message = level, message
    clock.now += 2 * MIN_INTERVAL
    assert updater.change_due()
    updater.statuses()
    clock.now += 1.0
    assert not updater.change_due()


def test_changed_numbers_are_not_due(clock):
    """Otherwise a counter in a message would cause a report per sample."""
    task = StubTask('Rates', WARN, 'Lost just now: 3 inertial')
    updater = Updater([task], 'bahrs_driver', '', clock)
    updater.statuses()
    clock.now += 0.1
    for message in ('Lost just now: 4 inertial', 'Lost just now: 1,024 inertial'):
        task.message = message
        clock.now += 0.1
        assert not updater.change_due()
    task.message = 'Lost just now: 4 inertial, 1 navigation'
    clock.now += 0.1
    assert updater.change_due()


def test_tasks_run_at_most_20_times_a_second(clock):
    """However often the data asks, which can be 3,000 times."""
    task = StubTask('Rates')
    updater, runs = Updater([task], 'bahrs_driver', '', clock), []
    task.run = lambda status: runs.append(status.now) or status
    for _ in range(1000):
        clock.now += 0.001
        updater.change_due()
    assert 18 <= len(runs) <= 21


@given(st.lists(st.tuples(
    st.floats(0.0, 0.2), st.sampled_from([OK, WARN, ERROR]), st.sampled_from('abc')),
    min_size=1))
def test_reports_are_limited_and_include_the_final_state(steps):
    """For any changes, if change_due() is called again after the interval."""
    clock, task = Clock(), StubTask('Integrity', OK, 'a')
    updater, reports = Updater([task], 'bahrs_driver', '', clock), []

    def report_change():
        if updater.change_due():
            (status,) = updater.statuses()
            reports.append((clock.now, status.level, status.message))

    for pause, task.level, task.message in steps:
        clock.now += pause
        report_change()
    clock.now += 1.01 * MIN_INTERVAL
    report_change()
    assert reports[-1][1:] == (task.level, task.message)
    assert all(after - before >= MIN_INTERVAL - 1e-9
               for (before, *_), (after, *_) in zip(reports, reports[1:]))


def test_self_test_passes_if_all_tests_pass():
    """It has the id of the device, and the tasks that can fail."""
    summaries = {'Link': Summary(OK, 'open'), 'Framing': Summary(OK, 'intact'),
                 'Rates': Summary(OK, 'right'), 'Integrity': Summary(OK, 'safe'),
                 'Publishing': Summary(OK, 'yes')}
    response = answer(summaries, '/dev/ttyUSB0', 'OSS-1', SelfTest.Response())
    assert response.passed == b'\x01' and response.id == 'OSS-1'
    assert [status.name for status in response.status] == [
        'Port open and bytes flowing', 'Frames valid', 'Rates right', 'Integrity safe']
    summaries['Integrity'] = Summary(WARN, 'roll integrity risk')
    response = answer(summaries, '/dev/ttyUSB0', 'OSS-1', SelfTest.Response())
    assert response.passed == b'\x00'
    assert response.status[3].message == 'roll integrity risk'


@pytest.mark.parametrize('task', ['Requests', 'Device'])
def test_self_test_includes_requests_and_device(task):
    """A polled device may have a good line and still publish nothing."""
    summaries = dict.fromkeys(('Link', 'Framing', 'Rates', 'Time', 'Requests', 'Device'),
                              Summary(OK, 'fine'))
    assert answer(summaries, '', '', SelfTest.Response()).passed == b'\x01'
    summaries[task] = Summary(WARN, 'not fine')
    response = answer(summaries, '', '', SelfTest.Response())
    assert response.passed == b'\x00'
    assert [status.message for status in response.status if status.level != OK] == ['not fine']
