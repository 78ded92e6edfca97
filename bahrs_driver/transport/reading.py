# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The result of a read."""

from typing import NamedTuple

from bahrs_driver.clock import Instant


class Reading(NamedTuple):
    """The bytes of one read, and the earliest known time by which all had arrived."""

    data: bytes
    now: Instant
