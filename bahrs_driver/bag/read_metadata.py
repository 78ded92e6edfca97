# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Metadata of a read, as the label of a `raw` message.

A std_msgs/UInt8MultiArray has no header. Its layout has a label for each dimension, and the driver
sets

    sensor=bahrs opening=1 byte_ns=86805 ros_ns=1700000000123456789 raw_ns=5000123456789

Any program that records the topic keeps the time of the read in it.
"""

from typing import NamedTuple

from bahrs_driver.units import NS_PER_S, ROS_TIME_END_S

END_OF_TIME = (ROS_TIME_END_S - 86_400) * NS_PER_S      # ns
NUMBER_LIMIT = 2 ** 63      # of numbers in 64 bits
_NUMBERS = ('opening', 'byte_ns', 'ros_ns', 'raw_ns')


class ReadMetadata(NamedTuple):
    """What was known when some bytes were read."""

    sensor: str
    connection_id: int  # counts the openings of the port: each begins a new stream
    byte_ns: int        # transmission time of a byte; 0 for a line without a rate
    ros_ns: int         # host ROS time of the read, in ns since the epoch
    raw_ns: int         # the same time on CLOCK_MONOTONIC_RAW

    def to_label(self) -> str:
        """Return the metadata as a label."""
        return ' '.join(f'{name}={value}' for name, value in zip(('sensor', *_NUMBERS), self))


def parse_label(label: str) -> ReadMetadata | None:
    """Return the metadata in a label; None if the driver did not write it."""
    words = dict(word.split('=', 1) for word in label.split() if '=' in word)
    try:
        numbers = [int(words[name]) for name in _NUMBERS]
        metadata = ReadMetadata(words['sensor'], *numbers)
        return metadata if metadata.ros_ns < END_OF_TIME and all(
            0 <= number < NUMBER_LIMIT for number in numbers) else None
    except (KeyError, ValueError):
        return None
