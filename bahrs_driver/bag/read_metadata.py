# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Where and when the bytes of a `raw` message were read, as a text.

A std_msgs/UInt8MultiArray has no header. Its layout has a label for each dimension, and ours says

    sensor=bahrs opening=1 byte_ns=86805 ros_ns=1700000000123456789 raw_ns=5000123456789

so that whoever records the topic, by whatever means, keeps the moment of the read itself.
"""

from typing import NamedTuple

from bahrs_driver.units import NS_PER_S, ROS_TIME_END_S


END_OF_TIME = (ROS_TIME_END_S - 86_400) * NS_PER_S
TOO_LARGE = 2 ** 63         # for a number in 64 bits


class Origin(NamedTuple):
    """What was known when some bytes were read."""

    sensor: str
    opening: int        # how often the port had been opened by then: a new one is a new stream
    byte_ns: int        # that a byte takes on the line, 0 if it has no rate
    ros_ns: int         # host ROS time of the read, in ns since the epoch
    raw_ns: int         # the same moment on CLOCK_MONOTONIC_RAW

    def label(self) -> str:
        """Return it as a text."""
        return ' '.join(f'{name}={value}' for name, value in self._asdict().items())


def parse_label(label: str) -> Origin | None:
    """Return what a label says; None if it is none of ours."""
    words = dict(word.split('=', 1) for word in label.split() if '=' in word)
    try:
        numbers = [int(words[name]) for name in Origin._fields[1:]]
        origin = Origin(words['sensor'], *numbers)
        return origin if origin.ros_ns < END_OF_TIME and all(
            0 <= number < TOO_LARGE for number in numbers) else None
    except (KeyError, ValueError):
        return None
