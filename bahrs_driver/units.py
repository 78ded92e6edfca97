# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Nanoseconds, and how long a byte takes."""

NANOSECONDS = 1_000_000_000
MILLISECOND = 1_000_000
MICROSECOND = 1_000
BITS_PER_BYTE = 10                      # 8N1: start bit, eight data bits, stop bit


def byte_time_ns(baud_rate: int) -> int:
    """Return how long a byte takes on the line, in nanoseconds; 0 for a line without a rate."""
    return BITS_PER_BYTE * NANOSECONDS // baud_rate if baud_rate else 0
