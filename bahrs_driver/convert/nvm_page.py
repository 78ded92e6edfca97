# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Pages of the non-volatile memory on a topic.

A std_msgs/UInt8MultiArray has no header. The label of its only dimension has the number of the
page, such as page=7, and its size is that of the page.
"""

from bahrs_driver.convert import raw
from bahrs_driver.convert.values import UInt8MultiArray

TOPIC = 'nvm/page'


def message(number: int, page: bytes) -> UInt8MultiArray:
    """Return the values that carry a page."""
    return raw.message(page, f'page={number}')
