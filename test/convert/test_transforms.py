# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the transforms between world, vehicle and device."""

from dataclasses import replace
import math

from bahrs_driver.convert.axes import (
    CONVENTIONS, flu_to_enu, NO_ROTATION, product, Quaternion, quaternion_from_euler,
    rotate_to_body,
)
from bahrs_driver.convert.bahrs.converter import BahrsConverter
from bahrs_driver.convert.titan_m.converter import TitanConverter
from bahrs_driver.convert.transforms import Mounting, TF
from bahrs_driver.convert.values import TransformStamped
from bahrs_driver.protocol.bahrs.messages import Navigation
from bahrs_driver.protocol.integrity import Integrity
from hypothesis import given, strategies as st
import pytest
from support.device_examples import (
    BAHRS_OPTIONS, GPS, INERTIAL, NAVIGATION, STATE, TITAN_OPTIONS,
)

ANGLES = st.tuples(st.floats(-7, 7), st.floats(-7, 7), st.floats(-7, 7))
QUARTER = math.pi / 2
STAMP = 1_700_000_000_123_456_789


def mounting(convention='enu', angles=(0.0, 0.0, 0.0)):
    """Return the mounting of a device ahead of the origin of the vehicle."""
    return Mounting('imu', 'base', (1.0, 2.0, 3.0), quaternion_from_euler(*angles),
                    CONVENTIONS[convention])


def rotation(transform):
    """Return the rotation of a transform, scalar first."""
    x, y, z, w = transform.rotation
    return Quaternion(w, x, y, z)


def rotated(quaternion, vector):
    """Return a vector of the child frame in the frame."""
    w, x, y, z = quaternion
    return pytest.approx(rotate_to_body(vector, Quaternion(w, -x, -y, -z)), abs=1e-12)


def test_the_static_transform_is_the_mounting():
    """Ahead in the vehicle is to the right of a device that is turned to the left."""
    (transform,) = mounting(angles=(0.0, 0.0, QUARTER)).transform(STAMP).transforms
    assert transform[:4] == (STAMP, 'base', 'imu', (1.0, 2.0, 3.0))
    assert (1.0, 0.0, 0.0) == rotated(rotation(transform), (0.0, -1.0, 0.0))


def test_z_of_a_ned_frame_points_down():
    """And x forward, without any angle."""
    turn = rotation(mounting('ned').transform(STAMP).transforms[0])
    assert (0.0, 0.0, -1.0) == rotated(turn, (0.0, 0.0, 1.0))
    assert (1.0, 0.0, 0.0) == rotated(turn, (1.0, 0.0, 0.0))


@given(attitude=ANGLES, angles=ANGLES, convention=st.sampled_from(['enu', 'ned']))
def test_both_transforms_together_are_the_orientation_of_the_device(attitude, angles, convention):
    """World to vehicle, then vehicle to device."""
    orientation = CONVENTIONS[convention].orientation(quaternion_from_euler(*attitude))
    place = mounting(convention, angles)
    (upper,) = place.attitude(STAMP, 'odom', orientation).transforms
    (lower,) = place.transform(STAMP).transforms
    assert upper[:4] == (STAMP, 'odom', 'base', (0.0, 0.0, 0.0))
    assert upper.child_frame_id == lower.frame_id
    assert product(rotation(upper), rotation(lower)) == pytest.approx(orientation, abs=1e-12)


@given(attitude=ANGLES, angles=ANGLES)
def test_the_vehicle_is_the_same_in_both_conventions(attitude, angles):
    """Only the axes of the world differ."""
    device = quaternion_from_euler(*attitude)
    in_enu, in_ned = (
        rotation(mounting(name, angles).attitude(
            STAMP, 'world', convention.orientation(device)).transforms[0])
        for name, convention in CONVENTIONS.items())
    # The vehicle has the same axes in both: turn them, as those of a device, before comparing.
    frd = product(in_ned, CONVENTIONS['ned'].axes)
    assert flu_to_enu(frd) == pytest.approx(in_enu, abs=1e-12) or \
        flu_to_enu(frd) == pytest.approx(tuple(-value for value in in_enu), abs=1e-12)


def transforms(converter, *messages):
    """Return the transforms that the last message gives."""
    for message in messages:
        outgoing = list(converter.convert(message, STAMP))
    return [transform for topic, values in outgoing if topic == TF
            for transform in values.transforms]


def bahrs(**options):
    """Return a converter of a BAHRS that publishes transforms."""
    return BahrsConverter(replace(BAHRS_OPTIONS, mounting=mounting(), **options))


def test_the_attitude_of_a_bahrs():
    """With the stamp of its sample."""
    level = replace(NAVIGATION, roll=0.0, pitch=0.0, magnetic_heading=QUARTER)
    (transform,) = transforms(bahrs(), INERTIAL, level)
    assert isinstance(transform, TransformStamped)
    assert transform[:3] == (STAMP, 'map', 'base')
    assert rotation(transform) == pytest.approx(NO_ROTATION)      # heading east


@pytest.mark.parametrize('signal', ['roll', 'pitch', 'magnetic_heading'])
def test_no_transform_without_the_whole_attitude(signal):
    """A transform cannot say that a part of it is unknown."""
    health = tuple(Integrity.UNAVAILABLE if name == signal else state
                   for name, state in zip(Navigation.SIGNALS, NAVIGATION.health))
    assert transforms(bahrs(), INERTIAL, replace(NAVIGATION, health=health)) == []


def test_the_attitude_of_a_titan_m():
    """None while it is not finite."""
    converter = TitanConverter(replace(TITAN_OPTIONS, mounting=mounting()))
    (transform,) = transforms(converter, GPS, STATE)
    assert rotation(transform) == pytest.approx(NO_ROTATION)      # heading east
    assert transforms(converter, replace(STATE, attitude=(0.0, math.nan, 0.0))) == []


def test_no_transform_without_a_subscriber_or_unless_asked_for():
    """By default, others publish the pose of the vehicle."""
    assert transforms(BahrsConverter(BAHRS_OPTIONS), INERTIAL, NAVIGATION) == []
    assert transforms(TitanConverter(TITAN_OPTIONS), GPS, STATE) == []
    unused = bahrs()
    unused.select({'imu/data'})
    assert transforms(unused, INERTIAL, NAVIGATION) == []
