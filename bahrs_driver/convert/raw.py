# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The topic `raw`: the bytes of each read."""

from array import array

from std_msgs.msg import MultiArrayDimension, MultiArrayLayout, UInt8MultiArray

TOPIC = 'raw'


def message(data: bytes, label: str) -> UInt8MultiArray:
    """Return the bytes of one read with a label."""
    size = len(data)
    dimension = MultiArrayDimension(label=label, size=size, stride=size)
    return UInt8MultiArray(layout=MultiArrayLayout(dim=[dimension]), data=array('B', data))
