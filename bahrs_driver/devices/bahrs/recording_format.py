# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How `bahrs report` reads the recorded frames of a BAHRS into arrays."""

from collections.abc import Mapping

from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.devices.recording_format import Limits, RecordingFormat
from bahrs_driver.protocol.bahrs.frames import (
    BahrsCodec,
    BahrsFormat,
    frame_size,
    frame_version,
    HEADER,
    MARKER,
)
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    FORCE,
    FORCE_2,
    HardwareVersion,
    HEIGHT,
    HEIGHT_OFFSET,
    Inertial,
    RATE,
    RATE_2,
    SoftwareVersion,
    VELOCITY,
    VERSIONS,
)
from bahrs_driver.protocol.bahrs.roles import ROLES

HIGHEST_RAW = 32767


def make_recording_format(settings: BahrsSettings, label: str) -> RecordingFormat:
    """Return how to read a recording with some settings."""
    frame_format = BahrsFormat(settings.crc_order)
    layouts = BahrsCodec(settings.pressure_height.format).layouts_by_header

    def sample_size(version: int | None) -> int:
        header = HEADER.pack(MARKER, version or VERSIONS[-1], Inertial.TYPE)
        return frame_size(layouts[header].size, padded=True)

    return RecordingFormat(
        label, frame_format, layouts, ROLES, Accuracy, SoftwareVersion, HardwareVersion,
        frame_version, sample_size, _limits, lambda: frame_format.order_seen)


def _limits(version: int | None) -> Mapping[str, Limits]:
    old = (version or VERSIONS[-1]) < 3
    return {
        'specific_force': _symmetric(FORCE_2 if old else FORCE),
        'angular_rate': _symmetric(RATE_2 if old else RATE),
        'velocity_down': _symmetric(VELOCITY),
        'pressure_height': (HEIGHT_OFFSET, HEIGHT_OFFSET + (2 * HIGHEST_RAW + 0.5) * HEIGHT)}


def _symmetric(scale: float) -> Limits:
    limit = (HIGHEST_RAW - 0.5) * scale
    return -limit, limit
