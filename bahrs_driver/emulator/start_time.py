# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The host's clocks at the start of an emulation."""

from typing import NamedTuple


class StartTime(NamedTuple):
    """Readings of the host's clocks in ns at time 0 of the emulation."""

    monotonic_ns: int = 0
    unix_ns: int = 0
