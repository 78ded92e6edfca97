# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Units of time, physical constants, and limits of the formats that all packages share."""

NS_PER_S = 1_000_000_000
NS_PER_MS = 1_000_000
NS_PER_US = 1_000
US_PER_S = 1_000_000
S_PER_NS = 1e-9
S_PER_US = 1e-6
ROS_TIME_END_S = 2 ** 31                # builtin_interfaces/Time holds seconds in an int32
STANDARD_GRAVITY = 9.80665              # m/s^2
COUNTER_MODULUS = 256                   # sequence numbers are uint8
BITS_PER_BYTE = 10                      # 8N1: start bit, eight data bits, stop bit


def byte_time_ns(baud_rate: int) -> int:
    """Return the transmission time of a byte in ns; 0 for a line without a baud rate."""
    return BITS_PER_BYTE * NS_PER_S // baud_rate if baud_rate else 0
