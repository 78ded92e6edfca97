# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a read of a port returns: bytes, and the host's time."""

from typing import NamedTuple

from bahrs_driver.clock import Instant


class Reading(NamedTuple):
    """The bytes of one read, and a time by which all were there, close to the first such."""

    data: bytes
    now: Instant
