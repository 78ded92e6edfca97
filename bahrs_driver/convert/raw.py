# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The topic `raw`: the bytes of each read."""

from bahrs_driver.convert.values import MultiArrayDimension, UInt8MultiArray

TOPIC = 'raw'


def message(data: bytes, label: str) -> UInt8MultiArray:
    """Return the bytes of one read with a label."""
    size = len(data)
    return UInt8MultiArray((MultiArrayDimension(label, size, size),), 0, data)
