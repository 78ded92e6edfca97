# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the conversion of a Titan-M's answers, with literal values."""

from dataclasses import replace
import math

from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.titan_m.converter import ABSENT_NS, TitanConverter, TOGETHER_NS, TOPICS
from bahrs_driver.protocol.titan_m.frames import Answer
from bahrs_driver.protocol.titan_m.messages import Gps, LAYOUTS, Sensors, State
import pytest
from sensor_msgs.msg import NavSatFix, NavSatStatus
from support.device_examples import DEVIATIONS, GPS, SENSORS, STATE, TITAN_OPTIONS
from support.ros_messages import as_messages, message_types

STAMP, MS = 1_700_000_000_123_456_789, 1_000_000
NAN = math.nan


def converter(convention='enu', **options):
    """Return a converter with literal options."""
    return TitanConverter(
        replace(TITAN_OPTIONS, convention=CONVENTIONS[convention], **options))


def converted(parts, message, stamp=STAMP):
    """Return the ROS messages of an answer with the rounding of the wire, by topic."""
    layout = LAYOUTS[type(message), 'little']
    out = list(as_messages(parts.convert(layout.decode(layout.encode(message)), stamp)))
    assert all(isinstance(ros, message_types(TOPICS)[topic]) for topic, ros in out)
    return dict(out)


def xyz(vector):
    """Return a vector as a tuple."""
    return vector.x, vector.y, vector.z


def test_sensors_in_ros_axes():
    """Axes are forward, left, up; imu/data has the calibrated values."""
    out = converted(converter(), SENSORS)
    assert set(out) == {'imu/data_raw', 'imu/mag', 'static_pressure', 'differential_pressure',
                        'temperature'}
    raw = out['imu/data_raw']
    assert raw.header.frame_id == 'imu' and raw.header.stamp.nanosec == 123_456_789
    assert xyz(raw.linear_acceleration) == pytest.approx((1.0, -2.0, 9.8), abs=0.013)
    assert xyz(raw.angular_velocity) == pytest.approx(
        tuple(math.radians(x) for x in (10.0, -20.0, -30.0)), abs=7e-4)
    assert raw.orientation_covariance[0] == -1
    # Rounding to counts of 2.522 mG and 0.07326 degree/s is part of it.
    assert raw.linear_acceleration_covariance[4] == pytest.approx(0.01 + 0.024732 ** 2 / 12, 1e-4)
    assert raw.angular_velocity_covariance[8] == pytest.approx(
        1e-4 + math.radians(0.07326) ** 2 / 12, 1e-4)
    assert xyz(out['imu/mag'].magnetic_field) == pytest.approx((2e-5, -1e-5, -4e-5), abs=4e-9)
    assert out['imu/mag'].magnetic_field_covariance[0] == pytest.approx(1e-12)
    assert out['static_pressure'].fluid_pressure == 95_000.0
    assert out['static_pressure'].variance == 100.0
    assert out['differential_pressure'].fluid_pressure == 125.0
    assert (out['temperature'].temperature, out['temperature'].variance) == (31.5, 0.25)


def test_state_in_ros_axes():
    """Axes are east, north, up, or those of the body; heading east is yaw 0."""
    out = converted(converter(), STATE)
    assert set(out) == {'imu/data', 'velocity', 'odometry', 'attitude/rpy', 'heading'}
    assert out['heading'].data == pytest.approx(90.0)
    assert out['velocity'].header.frame_id == 'map'
    assert xyz(out['velocity'].twist.twist.linear) == (4.0, 3.0, 1.0)
    assert out['velocity'].twist.covariance[0] == pytest.approx(0.04)
    assert out['velocity'].twist.covariance[21] == 1e6
    orientation = out['imu/data'].orientation
    assert (orientation.w, *xyz(orientation)) == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-7)
    assert out['imu/data'].orientation_covariance[0] == pytest.approx(4e-4)
    assert out['imu/data'].orientation_covariance[8] == pytest.approx(25e-4)
    # No sensor answer: neither is reported.
    assert out['imu/data'].linear_acceleration_covariance[0] == -1
    assert out['imu/data'].angular_velocity_covariance[0] == -1
    odometry = out['odometry']
    assert (odometry.header.frame_id, odometry.child_frame_id) == ('map', 'imu')
    assert xyz(odometry.pose.pose.position) == (200.0, 100.0, 50.0)
    assert xyz(odometry.twist.twist.linear) == pytest.approx((4.0, 3.0, 1.0), abs=1e-6)
    assert xyz(odometry.twist.twist.angular) == pytest.approx((0.1, -0.2, -0.3), abs=1e-7)
    assert odometry.pose.covariance[14] == 16.0 and odometry.pose.covariance[35] \
        == pytest.approx(25e-4)


def test_ned_changes_no_axes():
    """Axes are north, east, down, and forward, right, down."""
    parts = converter('ned')
    assert xyz(converted(parts, SENSORS)['imu/mag'].magnetic_field)[2] > 0
    out = converted(parts, STATE)
    assert xyz(out['imu/data'].linear_acceleration) == (0.5, 0.25, -9.75)
    assert xyz(out['odometry'].pose.pose.position) == (100.0, 200.0, -50.0)
    assert xyz(out['odometry'].twist.twist.linear) == pytest.approx((4.0, -3.0, -1.0), abs=1e-6)


@pytest.mark.parametrize('later, joined', [(6 * MS, True), (TOGETHER_NS + MS, False)])
def test_force_and_rate_are_those_of_the_preceding_sensor_answer(later, joined):
    """An older answer is not used."""
    parts = converter()
    converted(parts, SENSORS)
    imu = converted(parts, STATE, STAMP + later)['imu/data']
    assert imu.header.stamp.nanosec == 123_456_789 + later
    if joined:
        assert xyz(imu.linear_acceleration) == (0.5, -0.25, 9.75)
        assert xyz(imu.angular_velocity) == (0.125, 0.25, -0.5)
        assert imu.linear_acceleration_covariance[0] == pytest.approx(0.01)
    else:
        assert imu.linear_acceleration_covariance[0] == imu.angular_velocity_covariance[0] == -1


def test_fix():
    """The position is on the central meridian of zone 32; deviations are assumed."""
    out = converted(converter(), GPS)
    fix = out['fix']
    assert fix.longitude == pytest.approx(9.0) and fix.latitude == pytest.approx(45.15, abs=0.05)
    assert fix.altitude == 600.0 and fix.status.status == NavSatStatus.STATUS_FIX
    assert list(fix.position_covariance[::4]) == [4.0, 4.0, 16.0]
    assert fix.position_covariance_type == NavSatFix.COVARIANCE_TYPE_APPROXIMATED
    assert out['time_reference'].source == 'gps'
    assert out['time_reference'].time_ref.nanosec == 500_000_000
    assert 'velocity' not in out                # that of the state is better
    assert converted(converter(geoid_height=47.5), GPS)['fix'].altitude == 647.5


@pytest.mark.parametrize('zone', [0, 61, 255])
def test_an_invalid_zone_is_no_fix(zone):
    """The position is NaN."""
    parts = converter(requested={Gps, Sensors})
    out = converted(parts, replace(GPS, zone=zone))
    assert set(out) == {'fix', 'time_reference'}
    assert out['fix'].status.status == NavSatStatus.STATUS_NO_FIX
    assert math.isnan(out['fix'].latitude) and math.isnan(out['fix'].altitude)
    assert out['fix'].position_covariance_type == NavSatFix.COVARIANCE_TYPE_UNKNOWN
    assert parts.gps_status.lacks_fix and str(parts.gps_status) == 'no fix'
    converted(parts, replace(GPS, northern=False))
    assert str(parts.gps_status) == 'fix in zone 32 south'


def test_without_state_requests_the_velocity_is_that_of_the_gps():
    """Its resolution is a centimetre per second."""
    out = converted(converter(requested={Gps, Sensors}), GPS)
    assert xyz(out['velocity'].twist.twist.linear) == (2.0, 1.0, -3.0)


def test_odometry_begins_with_the_first_fix():
    """Positions are relative to the first fix."""
    parts = converter(requested={State, Gps})
    assert 'odometry' not in converted(parts, STATE)
    converted(parts, replace(GPS, zone=0))
    assert 'odometry' not in converted(parts, STATE)
    converted(parts, GPS)
    assert 'odometry' in converted(parts, STATE)
    parts.end_stream(STAMP)
    assert 'odometry' not in converted(parts, STATE)


def test_answers_to_other_programs_determine_the_topics():
    """A flight without GPS or state answers is converted as it was published."""
    late = STAMP + ABSENT_NS
    parts = converter(requested=None)
    assert 'velocity' not in converted(parts, GPS)               # a state may yet come
    assert 'velocity' in converted(parts, GPS, late)
    assert 'odometry' in converted(parts, STATE, late)
    assert 'velocity' not in converted(parts, GPS, late + MS)    # it has come
    parts.end_stream(late)
    assert 'odometry' not in converted(parts, STATE)             # nor is there a fix yet
    assert 'odometry' in converted(parts, STATE, late)
    converted(parts, replace(GPS, zone=0), late)
    assert 'odometry' not in converted(parts, STATE, late + MS)


def test_unknown_values_in_odometry_have_a_very_large_variance():
    """A deviation of 0 and a rate of NaN are unknown."""
    unknown = converter(deviations=replace(DEVIATIONS, attitude=0.0, heading=0.0))
    odometry = converted(unknown, replace(STATE, angular_rate=(0.1, NAN, 0.3)))['odometry']
    assert [odometry.pose.covariance[i] for i in (0, 14, 21, 28, 35)] == [4.0, 16.0, *[1e6] * 3]
    assert [odometry.twist.covariance[i] for i in (21, 28, 35)] == [1e6] * 3
    assert odometry.twist.covariance[0] == pytest.approx(0.04)


def test_unknown_gps_time_is_not_published():
    """Without a fix it is zero."""
    assert set(converted(converter(), replace(GPS, gps_time_s=0.0, zone=0))) == {'fix'}


@pytest.mark.parametrize('stamp, options, week', [
    (STAMP, {}, 2288), (STAMP, {'gps_week': 2287}, 2288), (5 * 10 ** 9, {'gps_week': 2300}, 2300)])
def test_utc_in_a_known_week(stamp, options, week):
    """The week is that of the host's clock, or of the parameter if the clock was never set."""
    parts = converter(**options)
    reference = converted(parts, GPS, stamp)['time_reference']
    assert reference.time_ref.sec == 315_964_800 + week * 604_800 + 1000 - 18
    assert bool(parts.week_problem) == (options.get('gps_week') == 2287)


def test_a_time_of_week_alone_is_not_published():
    """It would be a time in January 1970."""
    parts = converter()
    assert set(converted(parts, GPS, 5 * 10 ** 9)) == {'fix'}
    assert parts.week_problem and len(parts.take_notices()) == 1


def test_the_week_stays_when_the_gps_time_is_lost():
    """Without a fix the time is 0, which is not the beginning of a week."""
    parts = converter(gps_week=2300)
    before, unknown, after = (
        converted(parts, replace(GPS, gps_time_s=time)) for time in (500_000.0, 0.0, 500_010.0))
    assert 'time_reference' not in unknown
    assert after['time_reference'].time_ref.sec == before['time_reference'].time_ref.sec + 10


def test_nan_is_not_reported():
    """This holds for attitude, velocity and force."""
    parts = converter()
    converted(parts, replace(SENSORS, acceleration=(NAN, 0.0, 0.0)))
    out = converted(parts, replace(STATE, attitude=(NAN, 0.0, 0.0), velocity_ned=(0.0, NAN, 0.0)))
    assert set(out) == {'imu/data', 'attitude/rpy', 'heading'}
    assert all(map(math.isnan, (out['heading'].data, *xyz(out['attitude/rpy'].vector))))
    assert out['imu/data'].orientation_covariance[0] == -1
    assert out['imu/data'].linear_acceleration_covariance[0] == -1
    assert out['imu/data'].angular_velocity_covariance[0] == pytest.approx(1e-4)
    assert set(converted(parts, replace(SENSORS, magnetic_field_tesla=(0.0,) * 3,
                                        absolute_pressure=0.0))) == {
        'imu/data_raw', 'differential_pressure', 'temperature'}


@pytest.mark.parametrize('convention, degrees', [('enu', (10, -20, 55)), ('ned', (10, 20, 35))])
def test_roll_pitch_and_yaw(convention, degrees):
    """In radians, with the axes and the declination of imu/data."""
    out = converted(converter(convention, declination=math.radians(5.0)), replace(
        STATE, attitude=tuple(map(math.radians, (10, 20, 30)))))['attitude/rpy']
    assert out.header.frame_id == 'imu'
    assert tuple(map(math.degrees, xyz(out.vector))) == pytest.approx(degrees, abs=1e-5)


def test_declination_turns_yaw_and_not_the_heading():
    """The declination is ten degrees east."""
    out = converted(converter(declination=math.radians(10.0)), STATE)
    assert out['heading'].data == pytest.approx(90.0)
    yaw = 2 * math.atan2(out['imu/data'].orientation.z, out['imu/data'].orientation.w)
    assert math.degrees(yaw) == pytest.approx(-10.0, abs=1e-5)


@pytest.mark.parametrize('expected', [True, False])
def test_undecoded_and_unexpected_answers_are_neither_published_nor_kept(expected):
    """The decoder holds the former until their byte order is known."""
    parts = converter()
    payload = LAYOUTS[Sensors, 'little'].encode(SENSORS)
    assert list(parts.convert(Answer(Sensors, 0, payload, expected=expected), STAMP)) == []
    assert converted(parts, STATE)['imu/data'].linear_acceleration_covariance[0] == -1
