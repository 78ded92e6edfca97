# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the conversion of device messages to ROS messages."""

from dataclasses import replace
import math

from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs.converter import BahrsConverter, TOPICS
from bahrs_driver.convert.bahrs.integrity_policy import IntegrityPolicy
from bahrs_driver.protocol.bahrs.messages import (
    InertialTime, Navigation, SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.integrity import Integrity
import pytest
from support.device_examples import ACCURACY, BAHRS_OPTIONS as OPTIONS, INERTIAL, NAVIGATION
from support.ros_messages import as_messages, message_types

SAFE, RISK = Integrity.SAFE, Integrity.INTEGRITY_RISK
GONE, RESERVED = Integrity.UNAVAILABLE, Integrity.RESERVED

STAMP = 1_700_000_000_123_456_789


def published(*messages, **options):
    """Return the ROS messages of the last message, by topic."""
    converter = BahrsConverter(replace(OPTIONS, **options))
    for index, message in enumerate(messages):
        outgoing = dict(as_messages(converter.convert(message, STAMP + index)))
    return outgoing


def with_health(message, **states):
    """Return the message with other states of some signals, by name."""
    health = tuple(states.get(name, state)
                   for name, state in zip(message.SIGNALS, message.health))
    return replace(message, health=health)


def xyz(vector):
    """Return a geometry_msgs vector as a tuple."""
    return vector.x, vector.y, vector.z


def yaw_degrees(quaternion):
    """Return the yaw of a geometry_msgs quaternion."""
    q = quaternion
    return math.degrees(math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y ** 2 + q.z ** 2)))


def test_every_message_has_the_type_of_its_topic():
    """All topics are published if all signals are available."""
    converter, seen = BahrsConverter(OPTIONS), {}
    for message in (ACCURACY, INERTIAL, NAVIGATION, InertialTime(0, 1, 600_000),
                    SyncPulseTime(0, 601_000)):
        seen.update(as_messages(converter.convert(message, STAMP)))
    assert {topic: type(message) for topic, message in seen.items()} == \
        message_types(TOPICS)


def test_time_reference():
    """The header has the ROS time of a sample, time_ref its device time."""
    message = published(InertialTime(0, 1, 2_581_377))['time_reference']
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (
        1_700_000_000, 123_456_789)
    assert (message.time_ref.sec, message.time_ref.nanosec) == (2, 581_377_000)
    assert message.source == 'bahrs'


@pytest.mark.parametrize('message', [
    InertialTime(0, 0, 0), InertialTime(0, 1, 2 ** 64 - 1), SyncPulseTime(0, 2 ** 31 * 10 ** 6)])
def test_impossible_times_are_not_published(message):
    """The device has no time yet, or it is out of the range of ROS time."""
    assert published(message) == {}


def test_raw_imu():
    """The message has force and rate in FLU with their variances, and no orientation."""
    imu = published(INERTIAL)['imu/data_raw']
    assert imu.header.frame_id == 'imu_link'
    assert (imu.header.stamp.sec, imu.header.stamp.nanosec) == (1_700_000_000, 123_456_789)
    assert xyz(imu.linear_acceleration) == (0.1, -0.2, 9.7)
    assert xyz(imu.angular_velocity) == (0.01, -0.02, -0.03)
    assert imu.linear_acceleration_covariance[[0, 4, 8]] == pytest.approx([0.01] * 3)
    assert imu.angular_velocity_covariance[[0, 4, 8]] == pytest.approx([0.04] * 3)
    assert imu.orientation_covariance[0] == -1


def test_imu_has_orientation_and_the_sample_of_the_same_device_time():
    """Its stamp is that of the sample, not that of the navigation message."""
    imu = published(ACCURACY, INERTIAL, NAVIGATION)['imu/data']
    assert imu.header.stamp.nanosec == 123_456_790
    assert xyz(imu.linear_acceleration) == (0.1, -0.2, 9.7)
    assert yaw_degrees(imu.orientation) == pytest.approx(60)
    assert imu.orientation_covariance == pytest.approx(
        [4e-4, 0, 0, 0, 1e-4, 0, 0, 0, 9e-4])         # about east, north, up


def test_ned_changes_no_axes():
    """This holds for orientation, height, velocity and the order of the deviations."""
    out = published(ACCURACY, INERTIAL, NAVIGATION, convention=CONVENTIONS['ned'])
    assert xyz(out['imu/data'].linear_acceleration) == (0.1, 0.2, -9.7)
    assert yaw_degrees(out['imu/data'].orientation) == pytest.approx(30)
    assert out['imu/data'].orientation_covariance[[0, 4, 8]] == pytest.approx([1e-4, 4e-4, 9e-4])
    assert out['altitude/pose'].pose.pose.position.z == -1500
    assert out['velocity'].twist.twist.linear.z == -2


def test_after_a_lost_sample_only_orientation_is_published():
    """Force and rate of another time are not used."""
    late = replace(NAVIGATION, sequence=1)
    imu = published(ACCURACY, INERTIAL, NAVIGATION, late)['imu/data']
    assert imu.linear_acceleration_covariance[0] == -1
    assert imu.angular_velocity_covariance[0] == -1
    assert math.isnan(imu.linear_acceleration.x)
    assert yaw_degrees(imu.orientation) == pytest.approx(60)
    assert imu.header.stamp.nanosec == 123_456_792


@pytest.mark.parametrize('state', [GONE, RESERVED])
def test_a_single_missing_axis_is_nan(state):
    """The other axes keep their values."""
    imu = published(with_health(INERTIAL, specific_force_y=state))['imu/data_raw']
    x, y, z = xyz(imu.linear_acceleration)
    assert (x, z) == (0.1, 9.7) and math.isnan(y)
    assert imu.linear_acceleration_covariance[[0, 4, 8]] == pytest.approx([0.01, 1e6, 0.01])


def test_a_missing_quantity_is_not_reported():
    """The covariance of the rate begins with -1; the force stays."""
    imu = published(replace(INERTIAL, health=(SAFE,) * 3 + (GONE,) * 3))['imu/data_raw']
    assert imu.angular_velocity_covariance[0] == -1
    assert all(map(math.isnan, xyz(imu.angular_velocity)))
    assert imu.linear_acceleration_covariance[0] == pytest.approx(0.01)


def test_imu_topics_continue_without_available_signals():
    """All values are NaN and not reported; height and velocity are not published."""
    nothing = replace(INERTIAL, health=(GONE,) * 6)
    raw = published(nothing)
    assert set(raw) == {'integrity', 'imu/data_raw'}
    out = published(nothing, replace(NAVIGATION, health=(GONE,) * 5))
    assert set(out) == {'attitude/rpy', 'heading', 'integrity', 'imu/data'}
    assert all(map(math.isnan, (out['heading'].data, *xyz(out['attitude/rpy'].vector))))
    for imu in (raw['imu/data_raw'], out['imu/data']):
        assert all(map(math.isnan, (*xyz(imu.linear_acceleration), *xyz(imu.angular_velocity))))
        assert [matrix[0] for matrix in (
            imu.orientation_covariance, imu.linear_acceleration_covariance,
            imu.angular_velocity_covariance)] == [-1, -1, -1]


@pytest.mark.parametrize('policy, factor', [('inflate', 100), ('pass', 1)])
def test_signals_at_risk_are_published(policy, factor):
    """Their variance is larger, or unchanged; other signals do not change."""
    integrity_policy = IntegrityPolicy(policy, 100.0)
    risky = with_health(NAVIGATION, velocity_down=RISK, roll=RISK, magnetic_heading=RISK)
    out = published(ACCURACY, with_health(INERTIAL, specific_force_y=RISK), risky,
                    integrity_policy=integrity_policy)
    imu, base = out['imu/data'], published(ACCURACY, INERTIAL, NAVIGATION)
    assert imu.linear_acceleration_covariance[[0, 4, 8]] == pytest.approx(
        [0.01, 0.01 * factor, 0.01])
    assert imu.orientation_covariance == pytest.approx(
        base['imu/data'].orientation_covariance * factor)
    assert out['velocity'].twist.covariance[14] == pytest.approx(0.25 * factor)
    assert out['altitude/pose'].pose.covariance[14] == 4
    assert out['heading'].data == pytest.approx(30)


@pytest.mark.parametrize('signal', ['roll', 'pitch', 'magnetic_heading'])
def test_derived_values_have_the_risk_of_their_sources(signal):
    """The field across the heading has the risk of each of the three angles."""
    safe = published(ACCURACY, INERTIAL, replace(NAVIGATION, roll=0.0, pitch=0.0))['imu/mag']
    risky = published(ACCURACY, INERTIAL, with_health(
        replace(NAVIGATION, roll=0.0, pitch=0.0), **{signal: RISK}))['imu/mag']
    across = [-math.sin(math.radians(30)), math.cos(math.radians(30))]

    def variance(field):
        matrix = field.magnetic_field_covariance.reshape(3, 3)[:2, :2]
        return 1e12 * (across @ matrix @ across)        # in microtesla squared

    assert variance(risky) == pytest.approx(100 * variance(safe))


def test_signals_at_risk_may_be_withheld():
    """They are then treated as unavailable."""
    integrity_policy = IntegrityPolicy('withhold', 100.0)
    risky = with_health(NAVIGATION, velocity_down=RISK, roll=RISK, magnetic_heading=RISK)
    out = published(ACCURACY, with_health(INERTIAL, specific_force_y=RISK), risky,
                    integrity_policy=integrity_policy)
    assert 'velocity' not in out and 'imu/mag' not in out
    assert out['imu/data'].orientation_covariance[0] == -1
    assert math.isnan(out['imu/data'].linear_acceleration.y)
    assert math.isnan(out['heading'].data)


def test_a_signal_at_risk_without_accuracy_has_a_very_large_variance():
    """All zeros mean a safe signal of unknown accuracy."""
    imu = published(INERTIAL, with_health(NAVIGATION, roll=RISK))['imu/data']
    assert imu.orientation_covariance[[0, 4, 8]] == pytest.approx([1e6, 1e6, 1e6])


def states(notice):
    """Return the integrity in a notice, by signal."""
    return {status.name: (status.level, status.message) for status in notice.status}


def test_integrity_is_published_when_it_changes_with_the_stamp_of_the_sample():
    """It is not published otherwise; every notice has all signals."""
    converter = BahrsConverter(OPTIONS)
    first = dict(as_messages(converter.convert(INERTIAL, 1000)))['integrity']
    assert states(first)['specific_force_x'] == (b'\x00', 'safe')
    assert states(first)['roll'] == (b'\x03', 'not_heard')
    assert 'integrity' not in dict(as_messages(converter.convert(INERTIAL, 2000)))
    change = with_health(INERTIAL, angular_rate_z=RISK)
    out = dict(as_messages(converter.convert(change, 3000)))
    assert states(out['integrity'])['angular_rate_z'] == (b'\x01', 'integrity_risk')
    assert out['integrity'].header == out['imu/data_raw'].header
    change = with_health(NAVIGATION, roll=GONE, pitch=RESERVED)
    out = dict(as_messages(converter.convert(change, 3500)))
    assert states(out['integrity'])['roll'] == (b'\x02', 'unavailable')
    assert states(out['integrity'])['pitch'] == (b'\x02', 'reserved')
    assert states(out['integrity'])['angular_rate_z'] == (b'\x01', 'integrity_risk')
    assert out['integrity'].header.stamp == out['velocity'].header.stamp
    assert out['velocity'].header.stamp.nanosec == 3000
    assert len(states(out['integrity'])) == 11


def test_integrity_is_unknown_after_a_lost_stream():
    """The first sample of the next stream is a change again."""
    converter = BahrsConverter(OPTIONS)
    list(converter.convert(INERTIAL, 1000))
    notice = dict(converter.end_stream(5000))['integrity']
    assert set(states(notice).values()) == {(b'\x03', 'not_heard')}
    assert 'integrity' in dict(as_messages(converter.convert(INERTIAL, 6000)))


@pytest.mark.parametrize('signal, topics', [
    ('pressure_height', {'static_pressure', 'pressure_altitude', 'altitude/pose'}),
    ('velocity_down', {'velocity'}),
    ('roll', {'imu/mag'}),
    ('pitch', {'imu/mag'}),
    ('magnetic_heading', {'imu/mag'}),
])
def test_topics_of_an_unavailable_signal_are_not_published(signal, topics):
    """All other topics are published."""
    everything = set(published(INERTIAL, NAVIGATION))
    out = published(INERTIAL, with_health(NAVIGATION, **{signal: GONE}))
    assert everything - set(out) == topics


@pytest.mark.parametrize('convention, degrees', [('enu', (10, -20, 55)), ('ned', (10, 20, 35))])
def test_roll_pitch_and_yaw(convention, degrees):
    """In radians, with the axes and the declination of imu/data."""
    out = published(NAVIGATION, convention=CONVENTIONS[convention],
                    declination=math.radians(5.0))['attitude/rpy']
    assert out.header.frame_id == 'imu_link'
    assert tuple(map(math.degrees, xyz(out.vector))) == pytest.approx(degrees)


@pytest.mark.parametrize('signal', ['roll', 'pitch', 'magnetic_heading'])
def test_an_unavailable_angle_is_nan(signal):
    """The others are published: they are known without it."""
    everything = xyz(published(NAVIGATION)['attitude/rpy'].vector)
    without = xyz(published(with_health(NAVIGATION, **{signal: GONE}))['attitude/rpy'].vector)
    index = Navigation.SIGNALS[2:].index(signal)
    assert math.isnan(without[index])
    assert without[:index] + without[index + 1:] == everything[:index] + everything[index + 1:]


@pytest.mark.parametrize('signal', ['roll', 'pitch'])
def test_without_roll_or_pitch_there_is_no_orientation(signal):
    """Force and rate are still published."""
    imu = published(ACCURACY, INERTIAL, with_health(NAVIGATION, **{signal: GONE}))['imu/data']
    assert imu.orientation_covariance[0] == -1
    assert xyz(imu.linear_acceleration) == (0.1, -0.2, 9.7)
    assert imu.orientation.w == 1


def test_without_heading_roll_and_pitch_are_still_usable():
    """The yaw is that of heading north, with a variance that marks it as unknown."""
    imu = published(ACCURACY, INERTIAL, with_health(NAVIGATION, magnetic_heading=GONE))['imu/data']
    q = imu.orientation
    roll = math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x ** 2 + q.y ** 2))
    pitch = math.asin(2 * (q.w * q.y - q.z * q.x))
    assert math.degrees(roll) == pytest.approx(10)
    assert math.degrees(pitch) == pytest.approx(-20)
    assert yaw_degrees(q) == pytest.approx(90)
    # The direction of north is unknown: the larger of the two tilts counts for both.
    assert imu.orientation_covariance[[0, 4, 8]] == pytest.approx([4e-4, 4e-4, 1e6])


def test_orientation_without_accuracy_has_an_unknown_covariance():
    """Until the first accuracy message, it is all zeros."""
    imu = published(INERTIAL, NAVIGATION)['imu/data']
    assert list(imu.orientation_covariance) == [0] * 9


def test_accuracy_expires():
    """A second after the last accuracy message it is unknown again."""
    converter = BahrsConverter(OPTIONS)
    list(converter.convert(ACCURACY, STAMP))
    for _ in range(100):
        out = dict(as_messages(converter.convert(NAVIGATION, STAMP)))
    assert out['imu/data'].orientation_covariance[0] > 0
    out = dict(as_messages(converter.convert(NAVIGATION, STAMP)))
    assert list(out['imu/data'].orientation_covariance) == [0] * 9


def test_another_stream_uses_nothing_of_the_last():
    """Neither accuracy nor samples of the last stream are used."""
    converter = BahrsConverter(OPTIONS)
    for message in (ACCURACY, INERTIAL):
        list(converter.convert(message, STAMP))
    converter.end_stream(STAMP)
    imu = dict(as_messages(converter.convert(NAVIGATION, STAMP)))['imu/data']
    assert list(imu.orientation_covariance) == [0] * 9
    assert imu.linear_acceleration_covariance[0] == -1


def test_declination_turns_the_orientation_but_not_the_heading():
    """East is positive: true heading is 33 degrees, which is 57 in ENU."""
    out = published(INERTIAL, NAVIGATION, declination=math.radians(3))
    assert yaw_degrees(out['imu/data'].orientation) == pytest.approx(57)
    assert out['heading'].data == pytest.approx(30)


@pytest.mark.parametrize('heading, expected', [(-0.5, 331.35), (6.2831851641, 0.0), (3.2, 183.35)])
def test_heading_is_from_0_to_360(heading, expected):
    """Version 1 of the protocol counts from -pi to pi."""
    value = published(replace(NAVIGATION, magnetic_heading=heading))['heading'].data
    assert 0 <= value < 360
    assert math.remainder(value - expected, 360) == pytest.approx(0, abs=0.01)


def test_heights():
    """Pressure by the standard atmosphere, altitude without a fix, z in the world frame."""
    out = published(INERTIAL, NAVIGATION)
    pressure, fix, pose = (out[topic] for topic in
                           ('static_pressure', 'pressure_altitude', 'altitude/pose'))
    assert pressure.fluid_pressure == pytest.approx(84556.0, abs=0.5)
    assert math.sqrt(pressure.variance) == pytest.approx(2 * 10.377, rel=1e-3)
    assert fix.altitude == 1500 and math.isnan(fix.latitude) and math.isnan(fix.longitude)
    assert fix.status.status == -1
    assert fix.position_covariance[8] == 4 and fix.position_covariance_type == 2
    assert pose.header.frame_id == 'map'
    assert pose.pose.pose.position.z == 1500 and pose.pose.covariance[14] == 4


def test_velocity_is_upward():
    """The device climbs at 2 m/s."""
    twist = published(NAVIGATION)['velocity']
    assert twist.header.frame_id == 'map'
    assert twist.twist.twist.linear.z == 2 and twist.twist.covariance[14] == 0.25


def test_the_derived_field_can_be_turned_off():
    """publish.derived_magnetic_field is the parameter."""
    assert 'imu/mag' in published(NAVIGATION)
    assert 'imu/mag' not in published(NAVIGATION, publish_field=False)


def test_other_messages_are_not_converted():
    """Other modules handle them."""
    assert published(SoftwareVersion('OSS', 1, 2)) == {}


def stamp_of(message):
    """Return the stamp of a message in ns."""
    return message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec


def test_a_repeated_navigation_message_has_a_later_stamp():
    """It has the stamp of the clock, and the same values."""
    converter = BahrsConverter(OPTIONS)
    list(converter.convert(INERTIAL, STAMP))
    first = dict(as_messages(converter.convert(NAVIGATION, STAMP)))
    second = dict(as_messages(converter.convert(NAVIGATION, STAMP + 1)))
    for topic, message in first.items():
        if topic not in ('integrity', 'heading'):
            assert stamp_of(message) == STAMP and stamp_of(second[topic]) == STAMP + 1
    assert second['imu/data'].angular_velocity == first['imu/data'].angular_velocity


def test_an_inertial_sample_before_a_gap_does_not_match_a_message_after_it():
    """Its counter matches because it has wrapped."""
    converter = BahrsConverter(OPTIONS)
    list(converter.convert(INERTIAL, STAMP))
    outgoing = dict(as_messages(converter.convert(NAVIGATION, STAMP + 1_280_000_000)))
    assert stamp_of(outgoing['imu/data']) == STAMP + 1_280_000_000
    assert math.isnan(outgoing['imu/data'].angular_velocity.x)
