# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a frame format needs so that frames can be found in long blocks; it needs no numpy."""

from collections.abc import Callable, Mapping
from typing import Protocol

from bahrs_driver.protocol.framing import FrameFormat

Checksum = Callable[[bytes], bytes]     # of the bytes before it, as it stands in the frame


class BlockFormat(FrameFormat, Protocol):
    """A frame format whose frames end in a checksum of four bytes."""

    @property
    def single_sizes(self) -> Mapping[bytes, int]:
        """Sizes of frames by header, for headers with one size."""

    @property
    def first_checksum(self) -> Checksum:
        """Checksum that is tried first."""
