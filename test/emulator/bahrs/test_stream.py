# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the messages of an emulated BAHRS, compared with the recording of a real one."""

from itertools import islice
import math
import re

from bahrs_driver.emulator.bahrs.stream import BahrsStream, SIGNALS, UNALIGNED_MESSAGES
from bahrs_driver.emulator.flights import Still
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    FORCE_2,
    HEIGHT,
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    RATE_2,
)
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
import pytest
from support.emulated import make_device, make_emulation, on_the_wire
from support.shared_files import shared_file

SAFE, RISK, UNAVAILABLE = Integrity.SAFE, Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE
# Types of the messages of one tenth of a second, as the recording has them throughout.
TENTH = '15234' + '112' * 9 + '1'


def messages_of(samples, version=3, time_label='next', errors=None, truth=None, stream=None):
    """Return the messages of some samples, 5 ms apart from device time 1,000,000 us."""
    stream = stream or BahrsStream(version, time_label, errors or MeasurementErrors(1))
    return [message for index in range(samples)
            for message, _ in stream.sample(truth or Still().at(0.0), 1_000_000 + 5000 * index)]


def of(kind, messages):
    """Return the messages of one kind."""
    return [message for message in messages if isinstance(message, kind)]


def types(messages):
    """Return the types as a word."""
    return ''.join(f'{message.TYPE:X}' for message in messages)


def types_in(data):
    """Return the types of the frames in a stream, as a word."""
    framer = Framer(BahrsFormat())
    return ''.join(f'{frame.data[4]:X}' for frame in framer.feed(data) + framer.flush())


@pytest.mark.parametrize('version', [1, 2, 3])
def test_order_and_mix(version):
    """Twenty samples have the recording's pattern of a tenth of a second."""
    assert types(messages_of(60, version)) == TENTH * 3


@pytest.mark.slow
def test_order_and_mix_are_those_of_the_recording():
    """After the version message, the types are those of the real device."""
    real = types_in(shared_file('data/bahrs_recording_v2.bin').read_bytes())
    _, data = on_the_wire(make_emulation(make_device(version=2)), 241.0)
    ours = types_in(data).removeprefix('F')
    assert re.fullmatch(f'({TENTH})+1*(15?2?3?4?)?(112)*1*', real)
    assert ours.startswith(real)


def test_data_and_time_messages_count_for_themselves():
    """Each kind counts from 0, modulo 256."""
    messages = messages_of(20 * 260)
    for kind in (Inertial, Navigation, Accuracy, InertialTime, NavigationTime):
        counters = [message.sequence for message in of(kind, messages)]
        assert counters == [index % 256 for index in range(len(counters))]
        assert len(counters) > 256


@pytest.mark.parametrize(('label', 'ahead'), [('next', 1), ('same', 0)])
def test_a_time_message_names_the_next_sample_or_the_same(label, ahead):
    """The device time is that of the latest sample."""
    messages = messages_of(1000, time_label=label)
    inertial, navigation = of(InertialTime, messages), of(NavigationTime, messages)[1:]
    assert [(time.reference_sequence, time.device_time_us) for time in inertial] == [
        ((20 * index + ahead) % 256, 1_000_000 + 100_000 * index) for index in range(50)]
    assert [(time.reference_sequence, time.device_time_us) for time in navigation] == [
        ((10 * index + ahead) % 256, 1_000_000 + 100_000 * index) for index in range(1, 50)]


def test_accuracy_has_the_time_of_the_navigation_message_before_it():
    """The time message next to it has the same time."""
    messages = messages_of(100)
    assert [message.device_time_us for message in of(Accuracy, messages)] == [
        message.device_time_us for message in of(NavigationTime, messages)]


def test_the_beginning_is_that_of_the_recording():
    """Eight navigation messages have no signal; accuracy and navigation time are zero."""
    messages = messages_of(40)
    navigation = of(Navigation, messages)
    for message in navigation[:UNALIGNED_MESSAGES]:
        assert message.health == (UNAVAILABLE,) * 5
        assert message.pressure_height == -1000.0 and message.roll == 0.0
    assert navigation[UNALIGNED_MESSAGES].health == (SAFE,) * 5
    assert of(Accuracy, messages)[0] == Accuracy(0, None, None, None, 0)
    assert of(NavigationTime, messages)[0] == NavigationTime(0, 0, 0)
    assert of(InertialTime, messages)[0].valid


def test_accuracy_improves():
    """The deviation falls from 0.09 rad after power-on, as recorded, to half a degree and less."""
    accuracies = of(Accuracy, messages_of(20 * 600))[1:]
    assert accuracies[0].north_std == pytest.approx(0.091)
    assert accuracies[-1].north_std == pytest.approx(0.005)
    assert all(a.heading_std >= b.heading_std for a, b in zip(accuracies, accuracies[1:]))


@pytest.mark.parametrize('signal', SIGNALS)
@pytest.mark.parametrize('integrity', [RISK, UNAVAILABLE, Integrity.RESERVED])
def test_each_signal_can_be_put_in_each_state(signal, integrity):
    """States change at once, one by one, and back; an unavailable signal has a raw zero."""
    stream = BahrsStream(3, 'next', MeasurementErrors(1))
    messages_of(40, stream=stream)
    stream.set_integrity((signal,), integrity)
    kind = Inertial if signal in Inertial.SIGNALS else Navigation
    message = of(kind, messages_of(2, stream=stream))[0]
    expected = tuple(integrity if name == signal else SAFE for name in kind.SIGNALS)
    assert message.health == expected
    if integrity is UNAVAILABLE:
        blank = -1000.0 if signal == 'pressure_height' else 0.0
        assert value_of(message, signal) == blank
    stream.set_integrity((signal,))
    assert of(kind, messages_of(2, stream=stream))[0].health == (SAFE,) * len(kind.SIGNALS)


def value_of(message, signal):
    """Return the value of a signal in a message."""
    if signal in Navigation.SIGNALS:
        return getattr(message, signal)
    return getattr(message, signal[:-2])['xyz'.index(signal[-1])]


def test_large_values_are_limited():
    """Values are limited to the range of their fields."""
    biases = {'specific_force': (1e3, -1e3, 0.0), 'angular_rate': (99.0, -99.0, 0.0),
              'pressure_height': (1e5,), 'velocity_down': (-1e5,)}
    messages = messages_of(40, errors=MeasurementErrors(1, {}, biases))
    inertial, navigation = of(Inertial, messages)[-1], of(Navigation, messages)[-1]
    assert inertial.specific_force[:2] == (32767 * FORCE_2, -32767 * FORCE_2)
    assert inertial.angular_rate[:2] == (32767 * RATE_2, -32767 * RATE_2)
    assert navigation.pressure_height == -1000 + 65535 * HEIGHT
    assert navigation.velocity_down < -299.0


@pytest.mark.parametrize(('version', 'degrees', 'expected'), [
    (3, 359.9999, 359.9999), (3, 180.0, 180.0), (2, 270.0, 270.0), (1, 90.0, 90.0),
    (1, 270.0, -90.0), (1, 180.0, 179.997), (1, 181.0, -179.0)])
def test_the_range_of_the_heading_depends_on_the_version(version, degrees, expected):
    """Version 1 sends -180 to 180 degrees, the others 0 to 360."""
    truth = Still(heading=degrees).at(0.0)
    message = of(Navigation, messages_of(40, version, truth=truth))[-1]
    assert math.degrees(message.magnetic_heading) == pytest.approx(expected, abs=0.003)


def test_a_restart():
    """Counters are 0 and alignment is lost; the commanded integrity stays."""
    stream = BahrsStream(3, 'next', MeasurementErrors(1))
    first = messages_of(100, stream=stream)
    stream.set_integrity(('roll',), RISK)
    stream.restart()
    again = messages_of(100, stream=stream)
    assert types(again) == types(first)
    assert of(Navigation, again)[-1].health[2] is RISK
    assert list(islice((message.sequence for message in again), 5)) == [0, 0, 0, 0, 0]
