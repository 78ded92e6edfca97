# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Stamps of message objects."""

from bahrs_driver.units import NS_PER_S
from std_msgs.msg import Header


def nanoseconds(header: Header) -> int:
    """Return the stamp of a received header in ns; rclpy.time.Time raises for some stamps."""
    return int(header.stamp.sec * NS_PER_S + header.stamp.nanosec)


def make_header(stamp_ns: int, frame_id: str) -> Header:
    """Return a header; stamp_ns is in nanoseconds since the epoch."""
    message = Header(frame_id=frame_id)
    message.stamp.sec, message.stamp.nanosec = divmod(stamp_ns, NS_PER_S)
    return message
