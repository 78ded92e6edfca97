# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the formats of messages."""

import math

from bahrs_driver.convert import values
from bahrs_driver.convert.axes import CONVENTIONS, quaternion_from_euler
from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from bahrs_driver.devices.registry import all_topics
from bahrs_driver.monitor.values import attitude, FORMATS, number_text, vertical_force
from bahrs_driver.ros_layout.message_objects import to_message
import pytest

ANGLES = [math.radians(angle) for angle in (10.0, 20.0, 30.0)]
SPREAD = (1e-4,) + (0.0,) * 8


def imu(convention, force=(0.0, 0.0, -9.8)):
    """Return a message with roll 10, pitch 20 and heading 30 degrees."""
    axes = CONVENTIONS[convention]
    return to_message(values.imu(
        0, 'imu_link', axes.orientation(quaternion_from_euler(*ANGLES)), SPREAD,
        values.NO_VECTOR, SPREAD, axes.body(force), SPREAD))


def test_attitude():
    """Angles are those of the published frames."""
    assert attitude(imu('ned')) == pytest.approx((10, 20, 30))
    assert attitude(imu('enu')) == pytest.approx((10, -20, 60))


def test_attitude_that_is_not_reported():
    """A covariance of -1 means that there is no attitude."""
    message = imu('enu')
    message.orientation_covariance[0] = -1.0
    assert attitude(message) is None
    assert math.isnan(vertical_force(message))
    assert FORMATS['imu/data'](message) == 'no orientation'


@pytest.mark.parametrize('convention, pitch', [('ned', '+20.00°'), ('enu', '-20.00°')])
def test_unknown_yaw(convention, pitch):
    """A yaw of unknown variance is a dash."""
    message = imu(convention)
    message.orientation_covariance[8] = UNKNOWN_VARIANCE
    assert FORMATS['imu/data'](message) == f'roll +10.00° pitch {pitch} yaw -'


@pytest.mark.parametrize('w', [0.0, 2.0, math.nan, math.inf, 1e200])
def test_quaternion_that_is_no_rotation(w):
    """There is no attitude, as in an empty message with zeros."""
    message = imu('enu')
    for name in 'xyz':
        setattr(message.orientation, name, 0.0)
    message.orientation.w = w
    assert attitude(message) is None


@pytest.mark.parametrize('value, text', [
    (1.25, '+1.2 m'), (math.nan, '-'), (-math.inf, '-'), (1e300, '+1e+300 m'),
    (9999999.0, '+9999999.0 m')])
def test_number_text(value, text):
    """Huge numbers have an exponent, and numbers that are not finite are dashes."""
    assert number_text(value, '+.1f', ' m') == text


def test_vertical_force_shows_the_convention():
    """Specific force at rest points away from the ground."""
    roll, pitch, _ = ANGLES
    at_rest = (9.8 * math.sin(pitch), -9.8 * math.sin(roll) * math.cos(pitch),
               -9.8 * math.cos(roll) * math.cos(pitch))
    assert vertical_force(imu('enu', at_rest)) == pytest.approx(9.8)
    assert vertical_force(imu('ned', at_rest)) == pytest.approx(-9.8)


def test_nan_component():
    """A component that is NaN is a dash."""
    message = imu('enu', (math.nan, 1.0, -9.8))
    assert FORMATS['imu/data_raw'](message) == 'f - -1.00 +9.80  ω - - -'


def test_velocity():
    """Components that are not measured are not shown."""
    upward = to_message(values.vertical_twist(0, 'map', 1.5, 0.2))
    assert FORMATS['velocity'](upward) == 'z +1.50 m/s'
    upward.twist.covariance[0] = 0.04
    assert FORMATS['velocity'](upward) == 'x +0.00 y +0.00 z +1.50 m/s'


def test_angles():
    """In degrees; an unavailable one is a dash."""
    message = to_message(values.Vector3Stamped(0, 'imu', (math.radians(10.0), 0.0, math.nan)))
    assert FORMATS['attitude/rpy'](message) == 'roll +10.00° pitch +0.00° yaw -'


def test_every_topic_has_a_format():
    """The topics are those of all devices."""
    assert set(FORMATS) == set(all_topics())
