# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Pages of the non-volatile memory on a topic."""

from std_msgs.msg import UInt8MultiArray

TOPIC = 'nvm/page'


def message(page: bytes) -> UInt8MultiArray:
    """Return the message that carries a page."""
    return UInt8MultiArray(data=page)
