# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Make the mounting of a device from its settings."""

from bahrs_driver.convert.axes import CONVENTIONS, quaternion_from_euler
from bahrs_driver.convert.transforms import Mounting
from bahrs_driver.devices.settings import CommonSettings


def mounting(settings: CommonSettings) -> Mounting:
    """Return the pose of the device in the frame of the vehicle."""
    return Mounting(
        settings.frame_id, settings.base_frame_id,
        (settings.mounting.x, settings.mounting.y, settings.mounting.z),
        quaternion_from_euler(
            settings.mounting.roll, settings.mounting.pitch, settings.mounting.yaw),
        CONVENTIONS[settings.frame_convention])
