# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print the rate of pymavlink, on messages of an autopilot: RAW_IMU, ATTITUDE, SYSTEM_TIME."""

from pymavlink.dialects.v20 import common as mavlink
from throughput import chunks, mix, print_rate

ENCODER = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)


def inertial(index: int) -> bytes:
    """Return the inertial message of a sample."""
    values = [100 * place + index for place in range(9)]
    return bytes(mavlink.MAVLink_raw_imu_message(5000 * index, *values).pack(ENCODER))


def attitude(index: int) -> bytes:
    """Return the attitude message of a sample."""
    values = [place + index / 100 for place in range(6)]
    return bytes(mavlink.MAVLink_attitude_message(5 * index, *values).pack(ENCODER))


def clock(index: int) -> bytes:
    """Return the time message of a sample."""
    unix_us = 1_700_000_000_000_000 + 5000 * index
    return bytes(mavlink.MAVLink_system_time_message(unix_us, 5 * index).pack(ENCODER))


def count(data: bytes) -> int:
    """Return the count of intact messages."""
    parser, found = mavlink.MAVLink(None), 0
    parser.robust_parsing = True        # returns damage as BAD_DATA instead of raising
    for chunk in chunks(data):
        found += sum(message.get_msgId() >= 0 for message in parser.parse_buffer(chunk) or ())
    return found


if __name__ == '__main__':
    print_rate(count, mix(inertial, attitude, clock))
