# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The publishers of transforms, with topics and quality of service as in tf2_ros.

ROS from wheels has no tf2_msgs. Without it the node logs a warning and publishes everything else.
"""

from collections.abc import Callable
import time

from bahrs_driver.convert.transforms import TF, TF_STATIC
from bahrs_driver.convert.values import TFMessage
from bahrs_driver.devices.mounting import mounting
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.message_objects import is_installed, message_type, to_message
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

STATIC_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

CreatePublisher = Callable[..., Publisher]


class Transforms:
    """Publishes the mounting of the device once, and has a publisher for its attitude."""

    def __init__(self, settings: CommonSettings, create_publisher: CreatePublisher) -> None:
        """Create the publishers that the settings ask for, if tf2_msgs is installed."""
        wanted = {'publish.tf': settings.publish.tf,
                  'publish.static_tf': settings.publish.static_tf}
        self.attitude: Publisher | None = None
        self.warnings: list[str] = []
        if not is_installed(LAYOUTS[TFMessage]):
            self.warnings = [_not_published(name) for name, is_wanted in wanted.items()
                             if is_wanted]
            return
        kind = message_type(TFMessage)
        if settings.publish.tf:
            self.attitude = create_publisher(kind, TF)
        if settings.publish.static_tf:
            create_publisher(kind, TF_STATIC, STATIC_PROFILE).publish(
                to_message(mounting(settings).transform(time.time_ns())))


def _not_published(name: str) -> str:
    return (f'parameter {name} is true: transforms are not published, because the ROS package '
            f'tf2_msgs is not installed: install it (ros-jazzy-tf2-msgs) or set {name} to false')
