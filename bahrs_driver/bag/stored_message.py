# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A raw message in the storage of a bag."""

from typing import NamedTuple

RAW_TOPIC = 'raw'             # last part of the topic's name
RAW_TYPE = 'std_msgs/msg/UInt8MultiArray'
LARGEST_PART = 256 << 20        # bytes of a record, chunk or message; larger ones are refused


class StoredMessage(NamedTuple):
    """A serialized message of type RAW_TYPE."""

    topic: str
    log_time: int           # ns
    data: bytes
