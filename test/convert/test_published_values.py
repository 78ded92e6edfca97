# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Invariants of all published values, for generated messages of both devices.

A NaN, a variance of 0 and a quaternion whose sign flips are values that mislead consumers.
"""

from dataclasses import replace
import math

from bahrs_driver.convert import completeness, values
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs.converter import BahrsConverter
from bahrs_driver.convert.bahrs.integrity_policy import IntegrityPolicy
from bahrs_driver.convert.titan_m.converter import TitanConverter
from bahrs_driver.devices.registry import all_topics
from bahrs_driver.protocol.bahrs.messages import Accuracy, Inertial, Navigation
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.titan_m.messages import Gps, LAYOUTS, Sensors, State
from bahrs_driver.ros_layout.layouts import LAYOUTS as ROS_LAYOUTS
from bahrs_driver.ros_layout.rows import Kind
from diagnostic_msgs.msg import DiagnosticArray
from hypothesis import given, strategies as st
import numpy as np
import pytest
from sensor_msgs.msg import Imu, NavSatFix, TimeReference
from support.device_examples import (
    ACCURACY, BAHRS_OPTIONS, DEVIATIONS, GPS, INERTIAL, NAVIGATION, SENSORS, STATE, TITAN_OPTIONS,
)
from support.ros_messages import as_messages

STAMP, STEP = 1_700_000_000_000_000_000, 5_000_000
PARTIAL = {NavSatFix, TimeReference, DiagnosticArray}      # published as they are
CHECKED = set(all_topics().values()) - {values.NavSatFix, values.DiagnosticArray}
states = st.sampled_from(Integrity)
angles = st.floats(-math.pi, math.pi)
deviations = st.none() | st.floats(1e-4, 0.5)
vectors = st.tuples(*[st.floats(-10, 10, width=32)] * 3)
broken = st.tuples(*[st.floats(-10, 10, width=32) | st.just(math.nan) | st.just(math.inf)] * 3)


def with_sequence(messages):
    """Return messages with the counters of a device."""
    counts = {Inertial: 0, Navigation: 0, Accuracy: 0}
    for index, message in enumerate(messages):
        counts[type(message)] += 1
        messages[index] = replace(message, sequence=counts[type(message)] % 256)
    return messages


bahrs_streams = st.lists(st.one_of(
    st.builds(Inertial, st.just(0), vectors, vectors, st.tuples(*[states] * 6)),
    st.builds(Navigation, st.just(0), st.floats(-1000, 10_000), st.floats(-50, 50), angles,
              angles, angles, st.tuples(*[states] * 5)),
    st.builds(Accuracy, st.just(0), deviations, deviations, deviations, st.just(0))),
    max_size=20).map(with_sequence)
titan_streams = st.lists(st.one_of(
    st.builds(State, broken, broken, broken, broken),
    st.builds(lambda force, rate: replace(SENSORS, acceleration=force, angular_rate=rate),
              broken, broken),
    st.builds(lambda zone: replace(GPS, zone=zone), st.sampled_from([0, 1, 32, 60, 61]))),
    max_size=20)


def from_bahrs(stream, **options):
    """Return the ROS messages of a BAHRS's messages."""
    converter = BahrsConverter(replace(BAHRS_OPTIONS, **options))
    return [pair for index, message in enumerate(stream)
            for pair in as_messages(converter.convert(message, STAMP + STEP * index))]


def through_wire(message):
    """Return a message with the rounding of the wire."""
    layout = LAYOUTS[type(message), 'little']
    return layout.decode(layout.encode(message))


def from_titan(stream, **options):
    """Return the ROS messages of a Titan-M's answers."""
    options = {'requested': {State, Sensors, Gps}, **options}
    parts = TitanConverter(replace(TITAN_OPTIONS, **options))
    return [pair for index, message in enumerate(stream)
            for pair in as_messages(
                parts.convert(through_wire(message), STAMP + STEP * index))]


def matrices(message):
    """Yield the covariance matrices of a message."""
    for part in (message, getattr(message, 'pose', None), getattr(message, 'twist', None)):
        for name in part.get_fields_and_field_types() if part else ():
            if name.endswith('covariance') and len(getattr(part, name, ())):
                matrix = np.array(getattr(part, name))
                yield matrix.reshape(2 * [math.isqrt(len(matrix))])


def check_covariances(published, known):
    """Check that no variance is 0 beside another value, nor at all if all are known."""
    for topic, message in published:
        for matrix in matrices(message):
            diagonal = matrix.diagonal()
            if matrix[0, 0] == -1:
                assert not matrix[1:].any() and not matrix[0, 1:].any(), topic
            elif isinstance(message, NavSatFix) and message.status.status < 0 \
                    and math.isnan(message.altitude):
                assert message.position_covariance_type == NavSatFix.COVARIANCE_TYPE_UNKNOWN
            else:
                assert (diagonal > 0).all() or (not known and not matrix.any()), topic
                assert np.linalg.eigvalsh(matrix).min() >= -1e-9 * diagonal.max(), topic
        if known and hasattr(message, 'variance'):
            assert message.variance > 0


def check_imu(published):
    """Check that NaN is marked as not reported, or has the unknown variance."""
    for _, message in published:
        if isinstance(message, Imu):
            for vector, matrix in (
                    (message.angular_velocity, message.angular_velocity_covariance),
                    (message.linear_acceleration, message.linear_acceleration_covariance)):
                found = np.array([vector.x, vector.y, vector.z])
                assert not np.isinf(found).any()
                assert matrix[0] == -1 or (matrix[[0, 4, 8]][np.isnan(found)] == 1e6).all()
            q = message.orientation
            assert math.hypot(q.w, q.x, q.y, q.z) == pytest.approx(1)


@given(bahrs_streams, st.sampled_from(['inflate', 'withhold', 'pass']),
       st.sampled_from([0.0, 0.2, -2.0]))
def test_no_variance_of_a_bahrs_is_zero(stream, policy, declination):
    """All deviations are known, and any signals are available."""
    published = from_bahrs(stream, integrity_policy=IntegrityPolicy(policy, 100.0),
                           declination=declination,
                           orientation_fallback=0.1, field_dip=1.0)
    check_covariances(published, True)
    check_imu(published)


@given(bahrs_streams)
def test_a_deviation_of_0_is_unknown_for_a_bahrs(stream):
    """The variance is 0 in a matrix of zeros, or 1e6 beside known ones."""
    published = from_bahrs(stream, force_stddev=0.0, rate_stddev=0.0, height_stddev=0.0,
                           velocity_stddev=0.0)
    check_covariances(published, False)
    check_imu(published)


@given(titan_streams, st.booleans())
def test_no_variance_of_a_titan_m_is_zero(stream, known):
    """If the user sets it to unknown, it is 0 only in a matrix of zeros."""
    unknown = replace(DEVIATIONS, **dict.fromkeys(
        ('attitude', 'velocity', 'position', 'field', 'force'), 0.0))
    published = from_titan(stream, deviations=DEVIATIONS if known else unknown)
    check_covariances(published, known)
    check_imu(published)


@given(bahrs_streams)
def test_imu_topics_of_a_bahrs_never_stop(stream):
    """Each message of the device gives one, for any available signals."""
    topics = [topic for topic, _ in from_bahrs(stream)]
    assert topics.count('imu/data_raw') == sum(type(m) is Inertial for m in stream)
    assert topics.count('imu/data') == sum(type(m) is Navigation for m in stream)


@given(titan_streams)
def test_imu_topics_of_a_titan_m_never_stop(stream):
    """Each answer gives one message."""
    topics = [topic for topic, _ in from_titan(stream)]
    assert topics.count('imu/data_raw') == sum(type(m) is Sensors for m in stream)
    assert topics.count('imu/data') == sum(type(m) is State for m in stream)


def numbers(value):
    """Yield every number in a message, arrays and nested messages included."""
    if hasattr(value, 'get_fields_and_field_types'):
        for name in value.get_fields_and_field_types():
            yield from numbers(getattr(value, name))
    elif isinstance(value, float):
        yield value
    elif isinstance(value, np.ndarray):
        yield from value.tolist()


def has_nan(message):
    """Return whether any number in a message is NaN."""
    return any(map(math.isnan, numbers(message)))


@given(bahrs_streams, titan_streams)
def test_exactly_the_messages_with_a_nan_are_withheld(bahrs_stream, titan_stream):
    """A NavSatFix is published in any case."""
    for convert, stream in ((from_bahrs, bahrs_stream), (from_titan, titan_stream)):
        kept = convert(stream, withhold_incomplete=True)
        expected = [pair for pair in convert(stream)
                    if type(pair[1]) in PARTIAL or not has_nan(pair[1])]
        # NaN is not equal to itself.
        assert list(map(repr, kept)) == list(map(repr, expected))


@given(bahrs_streams, titan_streams)
def test_a_vector_with_a_nan_is_not_reported(bahrs_stream, titan_stream):
    """With not_reported, for a BAHRS; always, for a Titan-M. No other value changes."""
    whole = from_bahrs(bahrs_stream, whole_vectors=True)
    for imu in (message for _, message in [*whole, *from_titan(titan_stream)]
                if isinstance(message, Imu)):
        for vector, spread in ((imu.linear_acceleration, imu.linear_acceleration_covariance),
                               (imu.angular_velocity, imu.angular_velocity_covariance)):
            assert any(map(math.isnan, numbers(vector))) == (spread[0] == -1)
    # NaN is not equal to itself.
    assert [repr(pair) for pair in whole if not has_nan(pair[1])] == [
        repr(pair) for pair in from_bahrs(bahrs_stream) if not has_nan(pair[1])]


@pytest.mark.parametrize('kind', sorted(CHECKED, key=str))
def test_completeness_examines_every_number(kind):
    """This holds for all published values; covariances are always numbers."""
    for field, example in enumerate(examples(kind)):
        whole = kind(*examples(kind))
        assert completeness.complete(whole)
        for broken_field in with_nan(example):
            assert not completeness.complete(whole[:field] + (broken_field,)
                                             + whole[field + 1:]), kind._fields[field]


def examples(kind):
    """Return a value of each field."""
    made = {Kind.TEXT: lambda row: 'x', Kind.TIME: lambda row: 1,
            Kind.NUMBERS: lambda row: (0.5,) * row.length, Kind.NUMBER: lambda row: 0.5}
    return [made[row.kind](row) for row in ROS_LAYOUTS[kind].rows]


def with_nan(example):
    """Yield the value with NaN in place of each number."""
    if isinstance(example, float):
        yield math.nan
    elif isinstance(example, tuple):
        for index in range(len(example)):
            yield example[:index] + (math.nan,) + example[index + 1:]


def quaternions(published, topic='imu/data'):
    """Return the orientations of a topic as an array, w last."""
    found = [message.pose.pose.orientation if topic == 'odometry' else message.orientation
             for name, message in published if name == topic]
    return np.array([(q.x, q.y, q.z, q.w) for q in found])


def turning(kind, angle):
    """Return a message of a device that has turned by an angle."""
    attitude = (0.1, 0.2, math.remainder(angle, 2 * math.pi))
    return replace(STATE, attitude=attitude) if kind is State else replace(
        NAVIGATION, magnetic_heading=angle % (2 * math.pi))


@pytest.mark.parametrize('kind, convert', [(Navigation, from_bahrs), (State, from_titan)])
@pytest.mark.parametrize('convention', ['enu', 'ned'])
def test_the_sign_of_the_quaternion_is_continuous_over_two_turns(kind, convert, convention):
    """The heading wraps; odometry has the same sign."""
    stream = [turning(kind, math.radians(angle)) for angle in range(0, 721, 5)]
    if kind is State:
        stream = [GPS, *stream]
        published = from_titan(stream, convention=CONVENTIONS[convention])
        assert np.array_equal(quaternions(published, 'odometry'), quaternions(published))
    else:
        published = from_bahrs(stream, convention=CONVENTIONS[convention])
    found = quaternions(published)
    assert len(found) == 145
    assert (np.sum(found[1:] * found[:-1], axis=1) > 0.99).all()


@given(st.lists(st.tuples(angles, angles, angles), min_size=2, max_size=20))
def test_the_sign_is_the_nearer_one(attitudes):
    """At the start and after a lost link, w is positive."""
    converter = BahrsConverter(BAHRS_OPTIONS)
    for _ in range(2):
        found = quaternions([pair for roll, pitch, heading in attitudes
                             for pair in as_messages(converter.convert(replace(
                                 NAVIGATION, roll=roll, pitch=pitch, magnetic_heading=heading),
                                 STAMP))])
        assert (np.sum(found[1:] * found[:-1], axis=1) >= -1e-12).all()
        assert found[0][3] >= 0
        list(converter.end_stream(STAMP))


def test_an_attitude_that_is_unavailable_for_a_while_keeps_the_sign():
    """Orientations in between are marked as not reported."""
    gone = replace(NAVIGATION, health=(Integrity.UNAVAILABLE,) * 5)
    stream = [turning(Navigation, math.radians(angle)) for angle in range(0, 400, 5)]
    out = from_bahrs([ACCURACY, INERTIAL, *stream, gone, stream[-1]])
    found = quaternions(out)
    assert np.array_equal(found[-1], found[-3]) and found[-2][3] == 1
