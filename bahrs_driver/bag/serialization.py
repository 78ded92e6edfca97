# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Serialize ROS messages (CDR), always to the same bytes.

The middleware does not initialize the padding between fields. rosbags writes zeros there, and
accepts messages of ROS as its own, except for bytes and arrays of bytes.
"""

from collections.abc import Callable, Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

from bahrs_driver.bag.topics import typestore
from bahrs_driver.ros_layout.layouts import LAYOUTS
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import numpy as np
from std_msgs.msg import UInt8MultiArray


@cache
def type_name(kind: type) -> str:
    """Return the name of a message type, such as sensor_msgs/msg/Imu."""
    package, *_ = kind.__module__.split('.')
    return f'{package}/msg/{kind.__name__}'


def serialized(message: Any) -> bytes:
    """Serialize values of convert.values, or a message object."""
    kind: type = type(message)
    if layout := LAYOUTS.get(kind):
        return layout.serialize(message)
    adapt = _ADAPTERS.get(kind)
    name = type_name(kind)
    return bytes(typestore().serialize_cdr(adapt(message) if adapt else message, name))


def _diagnostics(message: DiagnosticArray) -> SimpleNamespace:
    return SimpleNamespace(header=message.header, status=list(map(_status, message.status)))


def _status(status: DiagnosticStatus) -> SimpleNamespace:
    return SimpleNamespace(level=status.level[0], name=status.name, message=status.message,
                           hardware_id=status.hardware_id, values=status.values)


def _bytes(message: UInt8MultiArray) -> SimpleNamespace:
    return SimpleNamespace(layout=message.layout, data=np.frombuffer(message.data, np.uint8))


_ADAPTERS: Mapping[type, Callable[..., SimpleNamespace]] = {
    DiagnosticArray: _diagnostics, UInt8MultiArray: _bytes}
