# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What is read from the storage of a bag, whichever kind it is."""

from typing import NamedTuple

RAW_TYPE = 'std_msgs/msg/UInt8MultiArray'
LARGEST_PART = 256 << 20        # bytes of a record, a chunk or a message; a larger one is refused


class StoredMessage(NamedTuple):
    """A serialised message of the type that raw bytes have."""

    topic: str
    log_time: int           # ns
    data: bytes
