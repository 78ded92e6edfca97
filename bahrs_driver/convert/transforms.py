# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Transforms between the frames of world, vehicle and device.

The vehicle's frame has the axes of REP-103, forward, left, up, in either convention. The mounting
is the pose of the device's forward, left, up axes in it. With the convention `ned` the frame of
the device is turned by half a turn about its x axis, so that its z axis points down.
"""

from typing import NamedTuple

from bahrs_driver.convert.axes import conjugate, Convention, product, Quaternion
from bahrs_driver.convert.values import TFMessage, TransformStamped, xyzw
from bahrs_driver.protocol.layout import Vector

TF, TF_STATIC = '/tf', '/tf_static'
_ORIGIN: Vector = (0.0, 0.0, 0.0)


class Mounting(NamedTuple):
    """The pose of the device in the frame of the vehicle."""

    frame_id: str
    base_frame_id: str
    position: Vector            # m
    rotation: Quaternion        # device to vehicle, both forward, left, up
    convention: Convention

    def transform(self, stamp_ns: int) -> TFMessage:
        """Return the transform from the vehicle to the device."""
        return TFMessage((TransformStamped(
            stamp_ns, self.base_frame_id, self.frame_id, self.position,
            xyzw(self._published())),))

    def attitude(self, stamp_ns: int, world_frame_id: str, orientation: Quaternion) -> TFMessage:
        """
        Return the transform from the world to the vehicle, for the orientation of the device.

        Its translation is zero: only the attitude is known.
        """
        return TFMessage((TransformStamped(
            stamp_ns, world_frame_id, self.base_frame_id, _ORIGIN,
            xyzw(product(orientation, conjugate(self._published())))),))

    def _published(self) -> Quaternion:
        """Return the rotation from the published axes of the device to the vehicle."""
        return product(self.rotation, self.convention.axes)
