# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the task Rates."""

from bahrs_driver.diagnostics.losses import missing
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.task import OK, STALE, WARN
from bahrs_driver.protocol.bahrs.messages import Acknowledgement, Inertial
from bahrs_driver.protocol.integrity import Integrity
import pytest
from support.tasks import summary_of, values_of


def inertial(sequence):
    """Return an inertial message with a counter."""
    return Inertial(sequence % 256, (0.0,) * 3, (0.0,) * 3, (Integrity.SAFE,) * 6)


@pytest.mark.parametrize('last, sequence, seconds, lost', [
    (7, 8, 0.005, 0),
    (7, 10, 0.015, 2),
    (255, 0, 0.005, 0),
    (250, 5, 0.055, 10),
    (7, 7, 0.0, 0),             # repeated
    (7, 8, 1.285, 256),         # the counter wraps once
    (7, 8, 1.300, 256),         # and the last frame is late
    (7, 6, 0.016, 0),           # no wrap in three periods: the device restarted
    (0, 100, 3.06, 611),
])
def test_lost_messages_by_counter_and_time(last, sequence, seconds, lost):
    """The message rate is 200 Hz."""
    assert missing(last, 10.0, sequence, 10.0 + seconds, 200.0) == lost


class Stream:
    """Feeds a task with inertial messages at 200 Hz."""

    def __init__(self):
        """Begin at time 0."""
        self.task = RatesTask({'inertial': 200.0}, 0.05, 1.0)
        self.now, self.sequence = 0.0, 0

    def run(self, seconds, rate=200, lose=()):
        """Send messages for some seconds, except those with an index in lose."""
        for index in range(int(seconds * rate)):
            self.now += 1 / rate
            self.sequence += 1
            if index not in lose:
                self.task.observe(inertial(self.sequence), self.now)
                summary = summary_of(self.task, self.now)
        return summary


def test_a_complete_stream_is_ok():
    """The counter wraps several times."""
    stream = Stream()
    assert stream.run(6) == (OK, 'All messages at their rates')
    values = values_of(stream.task, stream.now)
    assert values == {'inertial [Hz]': '200.0 of 200', 'inertial received': '1200',
                      'inertial lost': '0'}


def test_losses_are_counted_and_reported_for_a_while():
    """Later the level is OK again, and the count remains."""
    stream = Stream()
    stream.run(1)
    summary = stream.run(0.5, lose={50, 51, 56, 70})
    assert summary == (WARN, 'Lost just now: 4 inertial')
    assert stream.run(5).level == OK
    assert stream.task.lost == {'inertial': 4}


def test_a_wrong_rate_is_reported():
    """The counter has no gaps, but the device sends too slowly."""
    assert Stream().run(6, rate=180).message == 'inertial at 180 Hz instead of 200'


def test_messages_held_back_by_a_host_are_no_wrong_rate():
    """They arrive late and all at once: too few in one span, too many in the next."""
    stream = Stream()
    stream.run(3)
    for _ in range(5):
        held = [inertial(stream.sequence + index) for index in range(1, 61)]
        stream.sequence, stream.now = stream.sequence + 60, stream.now + 0.3
        assert summary_of(stream.task, stream.now).level == OK
        for message in held:
            stream.task.observe(message, stream.now)
        assert stream.run(4.1) == (OK, 'All messages at their rates')


def test_a_rate_near_its_tolerance_rarely_changes_the_level():
    """Each change of level is published at once."""
    stream, levels = Stream(), []
    for turn in range(400):
        levels.append(stream.run(0.05, rate=(200, 220, 220)[turn % 3]).level)
    changes = sum(before != after for before, after in zip(levels, levels[1:]))
    assert changes <= stream.now / 2


def test_a_pause_is_no_wrong_rate():
    """At the start of the real device, it is 2.7 s long, and the stream is reported as stale."""
    stream = Stream()
    stream.run(0.005)
    assert summary_of(stream.task, stream.now + 2.7).level == STALE
    stream.now += 2.7
    for _ in range(50):
        assert stream.run(0.1) == (OK, 'All messages at their rates')


def test_a_stream_is_stale_before_its_start_and_after_its_end():
    """It ends after the time-out of 1 s."""
    stream = Stream()
    assert summary_of(stream.task, 0.0) == (STALE, 'No data from the device')
    stream.run(3)
    assert summary_of(stream.task, stream.now + 0.9).level != STALE
    assert summary_of(stream.task, stream.now + 1.1).level == STALE


def test_diagnostics_mode_is_not_an_error():
    """The device sends service messages and no data."""
    stream = Stream()
    stream.run(1)
    stream.task.observe(Acknowledgement(0xF0, 0), stream.now + 0.5)
    level, message = summary_of(stream.task, stream.now + 2)
    assert level == STALE and 'diagnostics mode' in message
    assert 'diagnostics mode' not in summary_of(stream.task, stream.now + 30).message


def test_restart_is_no_loss():
    """The counters of two streams are independent."""
    stream = Stream()
    stream.run(1)
    stream.task.restart()
    stream.sequence += 100
    stream.run(1)
    assert not stream.task.lost


@pytest.mark.parametrize('pause', [0.6, 2.7, 30.0])
def test_a_pause_of_the_device_is_no_loss(pause):
    """At the start of the real device, the counter continues after the pause."""
    stream = Stream()
    stream.run(0.1)
    stream.now += pause
    stream.run(1)
    assert not stream.task.lost


def test_diagnostics_mode_is_no_loss():
    """The counter may continue anywhere afterwards."""
    stream = Stream()
    stream.run(1)
    stream.task.observe(Acknowledgement(0xF0, 0), stream.now + 0.1)
    stream.now += 0.3
    stream.sequence += 60
    stream.run(1)
    assert not stream.task.lost


def test_rates_are_measured_from_the_first_message():
    """A device that starts late does not send too slowly."""
    task = RatesTask({'inertial': 200.0}, 0.05, 1.0)
    summary_of(task, 0.0)
    stream = Stream()
    stream.task, stream.now = task, 1.5
    assert stream.run(1).level == OK
    assert stream.run(3).level == OK
