# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Literal messages of both devices, and options to convert them with."""

import math

from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs.converter import BahrsOptions
from bahrs_driver.convert.bahrs.integrity_policy import IntegrityPolicy
from bahrs_driver.convert.titan_m.converter import TitanDeviations, TitanOptions
from bahrs_driver.protocol.bahrs.messages import Accuracy, Inertial, Navigation
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.titan_m.messages import Gps, Sensors, State

SAFE = Integrity.SAFE

INERTIAL = Inertial(0, (0.1, 0.2, -9.7), (0.01, 0.02, 0.03), (SAFE,) * 6)
NAVIGATION = Navigation(0, 1500.0, -2.0, math.radians(10), math.radians(20), math.radians(30),
                        (SAFE,) * 5)
ACCURACY = Accuracy(0, 0.01, 0.02, 0.03, 0)
BAHRS_OPTIONS = BahrsOptions(
    frame_id='imu_link', world_frame_id='map', convention=CONVENTIONS['enu'], force_stddev=0.1,
    rate_stddev=0.2, height_stddev=2.0, velocity_stddev=0.5, declination=0.0,
    field_strength=50e-6, field_dip=0.0, publish_field=True,
    integrity_policy=IntegrityPolicy('inflate', 100.0))

STATE = State((100.0, 200.0, -50.0), (3.0, 4.0, -1.0), (0.0, 0.0, math.pi / 2), (0.1, 0.2, 0.3))
GPS = Gps(1000.5, 500_000.0, 5_000_000.0, 600.0, (1.0, 2.0, 3.0), 90.0, 4.0, 3.0, 32, True)
SENSORS = Sensors((1.0, 2.0, -9.8), (10.0, 20.0, 30.0), 31.5, (0.5, 0.25, -9.75),
                  (0.125, -0.25, 0.5), 95_000.0, 125.0, (2e-5, 1e-5, 4e-5))
DEVIATIONS = TitanDeviations(
    force=0.1, rate=0.01, attitude=0.02, heading=0.05, velocity=0.2, position=2.0, altitude=4.0,
    field=1e-6, static_pressure=10.0, differential_pressure=2.0, temperature=0.5)
TITAN_OPTIONS = TitanOptions(
    'imu', 'map', CONVENTIONS['enu'], DEVIATIONS, declination=0.0, geoid_height=0.0,
    gps_week=0, leap_seconds=18, requested={State, Sensors})
