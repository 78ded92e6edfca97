# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Measurements of a Titan-M along a path, as answers."""

from collections.abc import Callable, Mapping
import math
from typing import NamedTuple

from bahrs_driver.convert import atmosphere
from bahrs_driver.convert.utm import from_wgs84, load_pyproj
from bahrs_driver.emulator.ground_path import GroundPath
from bahrs_driver.emulator.measurement_errors import clamp_vector, MeasurementErrors
from bahrs_driver.emulator.motion import Truth
from bahrs_driver.protocol.layout import Vector
from bahrs_driver.protocol.titan_m.messages import (
    ADC_FORCE,
    ADC_RATE_DEG,
    FIELD,
    Gps,
    Sensors,
    State,
    TitanAnswer,
)

ZONE_WIDTH = 6                      # degrees of longitude
WEEK_MS = 604_800_000
TEMPERATURE = 31.5                  # degree C, inside the device
NORTH_FIELD, DOWN_FIELD = 20e-6, 43e-6      # T
INT16_MAX = 32767
MAX_DIFFERENTIAL_PRESSURE = 1073.0      # Pa, by the range of its field


class MeasuredAnswer(NamedTuple):
    """An answer, and the true values of its fields."""

    message: TitanAnswer
    truth: Mapping[str, object]


class TitanMeasurements:
    """Makes measurements along a path. Positions are relative to the first GPS fix."""

    def __init__(self, path: GroundPath, errors: MeasurementErrors, gps_start_ms: int = 0) -> None:
        load_pyproj()
        self._path = path
        self._errors = errors
        self._gps_start_ms = gps_start_ms
        self._origin: tuple[float, float, float] | None = None
        self._measure_kind: dict[type[TitanAnswer], Callable[[float, bool], MeasuredAnswer]] = {
            State: self._state, Gps: self._gps, Sensors: self._sensors}

    def restart(self) -> None:
        """Forget the position of the first GPS fix."""
        self._origin = None

    def measure(self, kind: type[TitanAnswer], time: float, has_fix: bool) -> MeasuredAnswer:
        """Return an answer of a kind at a time in seconds, with or without a GPS fix."""
        return self._measure_kind[kind](time, has_fix)

    def _state(self, time: float, has_fix: bool) -> MeasuredAnswer:
        truth, position, (north, east) = self._path.at(time)
        if has_fix and self._origin is None:
            self._origin = north, east, position.altitude
        origin_north, origin_east, origin_altitude = self._origin or (
            north, east, position.altitude)
        true = {
            'position_ned': (north - origin_north, east - origin_east,
                             origin_altitude - position.altitude),
            'velocity_ned': truth.velocity,
            'attitude': (truth.roll, truth.pitch, truth.heading),
            'angular_rate': truth.angular_rate}
        return MeasuredAnswer(State(
            true['position_ned'], truth.velocity,
            self._errors.add_vector('attitude', true['attitude']),
            self._errors.add_vector('angular_rate', truth.angular_rate)), true)

    def _gps(self, time: float, has_fix: bool) -> MeasuredAnswer:
        truth, position, _ = self._path.at(time)
        if not has_fix:
            no_fix = Gps(0.0, 0.0, 0.0, 0.0, (0.0,) * 3, 0.0, 0.0, 0.0, 0, True)
            return MeasuredAnswer(no_fix, {})
        zone, northern = utm_zone(position.longitude), position.latitude >= 0
        easting, northing = from_wgs84(
            position.latitude, position.longitude, zone, northern)
        north, east, down = truth.velocity
        week_ms = (self._gps_start_ms + round(time * 1000)) % WEEK_MS
        course = math.degrees(math.atan2(east, north)) % 360.0
        message = Gps(week_ms / 1000, easting, northing, position.altitude, truth.velocity, course,
                      math.hypot(north, east, down), math.hypot(north, east), zone, northern)
        return MeasuredAnswer(message, {
            'latitude': position.latitude, 'longitude': position.longitude,
            'altitude': position.altitude, 'velocity_ned': truth.velocity, 'heading_deg': course,
            'gps_time_s': week_ms / 1000, 'zone': zone, 'northern': northern})

    def _sensors(self, time: float, _has_fix: bool) -> MeasuredAnswer:
        truth, position, _ = self._path.at(time)
        force = self._errors.add_vector('specific_force', truth.specific_force)
        rate = self._errors.add_vector('angular_rate', truth.angular_rate)
        pressure, magnetic = atmosphere.pressure(position.altitude), magnetic_field(truth)
        dynamic = atmosphere.density(position.altitude) / 2 * math.hypot(*truth.velocity) ** 2
        p, q, r = rate
        return MeasuredAnswer(Sensors(
            _within_field(force, ADC_FORCE),
            _within_field((math.degrees(p), math.degrees(q), math.degrees(r)), ADC_RATE_DEG),
            TEMPERATURE, force, rate, pressure, min(dynamic, MAX_DIFFERENTIAL_PRESSURE),
            _within_field(magnetic, FIELD)), {
                'acceleration': truth.specific_force, 'angular_rate': truth.angular_rate,
                'absolute_pressure': pressure, 'differential_pressure': dynamic,
                'magnetic_field_tesla': magnetic, 'temperature_c': TEMPERATURE})


def utm_zone(longitude: float) -> int:
    """Return the UTM zone of a longitude in degrees, without the exceptions in the north."""
    return int((longitude + 180.0) // ZONE_WIDTH) % 60 + 1


def magnetic_field(truth: Truth) -> Vector:
    """Return the magnetic field (T) in body axes."""
    sin_roll, cos_roll = math.sin(truth.roll), math.cos(truth.roll)
    sin_pitch, cos_pitch = math.sin(truth.pitch), math.cos(truth.pitch)
    forward = NORTH_FIELD * math.cos(truth.heading)
    right = -NORTH_FIELD * math.sin(truth.heading)
    below = sin_pitch * forward + cos_pitch * DOWN_FIELD
    return (cos_pitch * forward - sin_pitch * DOWN_FIELD,
            cos_roll * right + sin_roll * below, cos_roll * below - sin_roll * right)


def _within_field(vector: Vector, scale: float) -> Vector:
    """Limit a vector to the range of 16-bit fields of a scale."""
    return clamp_vector(vector, INT16_MAX * scale)
