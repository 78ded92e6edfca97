# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How `bahrs report` reads the recorded frames of a device into arrays."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from bahrs_driver.protocol.block_format import BlockFormat
from bahrs_driver.protocol.layout import Layout
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.message_roles import MessageRoles

Limits = tuple[float, float]


@dataclass(frozen=True)
class RecordingFormat:
    """Frames and message types of a recording; None as a version is the latest."""

    label: str                                      # name of the device in sentences
    frame_format: BlockFormat
    layouts: Mapping[bytes, Layout[Any]]            # by the header of a frame
    roles: MessageRoles
    accuracy: type[Message]
    software: type[Message]
    hardware: type[Message]
    version: Callable[[bytes], int]                 # protocol version of a header
    sample_size: Callable[[int | None], int]        # size of the frame of a sample, by version
    limits: Callable[[int | None], Mapping[str, Limits]]    # of saturated fields, by version
    checksum_order: Callable[[], str | None]        # as seen so far
