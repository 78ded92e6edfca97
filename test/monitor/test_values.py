# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what is read out of messages."""

import math

from bahrs_driver.convert import ros
from bahrs_driver.convert.axes import CONVENTIONS, quaternion_from_euler
from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from bahrs_driver.devices.registry import all_topics
from bahrs_driver.monitor.values import attitude, FORMATS, number, vertical_force
import pytest

ANGLES = [math.radians(angle) for angle in (10.0, 20.0, 30.0)]
SPREAD = (1e-4,) + (0.0,) * 8


def imu(convention, force=(0.0, 0.0, -9.8)):
    """Return a message of an aircraft that rolls 10, pitches 20 and heads 30 degrees."""
    axes = CONVENTIONS[convention]
    return ros.imu(ros.header(0, 'imu_link'), axes.orientation(quaternion_from_euler(*ANGLES)),
                   SPREAD, ros.NO_VECTOR, SPREAD, axes.body(force), SPREAD)


def test_attitude():
    """As the published frames have it."""
    assert attitude(imu('ned')) == pytest.approx((10, 20, 30))
    assert attitude(imu('enu')) == pytest.approx((10, -20, 60))


def test_an_attitude_that_is_not_reported():
    """It is none."""
    message = imu('enu')
    message.orientation_covariance[0] = -1.0
    assert attitude(message) is None
    assert math.isnan(vertical_force(message))
    assert FORMATS['imu/data'](message) == 'no orientation'


@pytest.mark.parametrize('convention, pitch', [('ned', '+20.00°'), ('enu', '-20.00°')])
def test_a_yaw_that_is_not_known(convention, pitch):
    """Its variance marks it."""
    message = imu(convention)
    message.orientation_covariance[8] = UNKNOWN_VARIANCE
    assert FORMATS['imu/data'](message) == f'roll +10.00° pitch {pitch} yaw -'


@pytest.mark.parametrize('w', [0.0, 2.0, math.nan, math.inf, 1e200])
def test_a_quaternion_that_is_no_rotation(w):
    """Such as the zeros of an empty message."""
    message = imu('enu')
    for name in 'xyz':
        setattr(message.orientation, name, 0.0)
    message.orientation.w = w
    assert attitude(message) is None


@pytest.mark.parametrize('value, text', [
    (1.25, '+1.2 m'), (math.nan, '-'), (-math.inf, '-'), (1e300, '+1e+300 m'),
    (9999999.0, '+9999999.0 m')])
def test_numbers_are_short(value, text):
    """And always numbers, or a dash."""
    assert number(value, '+.1f', ' m') == text


def test_what_holds_the_aircraft_up_tells_the_convention():
    """Specific force at rest points away from the ground."""
    roll, pitch, _ = ANGLES
    at_rest = (9.8 * math.sin(pitch), -9.8 * math.sin(roll) * math.cos(pitch),
               -9.8 * math.cos(roll) * math.cos(pitch))
    assert vertical_force(imu('enu', at_rest)) == pytest.approx(9.8)
    assert vertical_force(imu('ned', at_rest)) == pytest.approx(-9.8)


def test_what_is_not_reported_is_no_number():
    """A component that is NaN is a dash."""
    message = imu('enu', (math.nan, 1.0, -9.8))
    assert FORMATS['imu/data_raw'](message) == 'f - -1.00 +9.80  ω - - -'


def test_velocity():
    """What is not measured is not shown."""
    upward = ros.vertical_twist(ros.header(0, 'map'), 1.5, 0.2)
    assert FORMATS['velocity'](upward) == 'z +1.50 m/s'
    upward.twist.covariance[0] = 0.04
    assert FORMATS['velocity'](upward) == 'x +0.00 y +0.00 z +1.50 m/s'


def test_every_topic_has_its_words():
    """None is forgotten."""
    assert set(FORMATS) == set(all_topics())
