# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print the rate of pyubx2, on messages of an inertial sensor: ESF-INS, NAV-ATT, NAV-CLOCK."""

import io

from pyubx2 import ERR_IGNORE, GET, UBX_PROTOCOL, UBXMessage, UBXReader, VALCKSUM
from throughput import CHUNK, mix, print_rate

VALID = {f'{axis}{name}Valid': 1 for axis in 'xyz' for name in ('AngRate', 'Accel')}


def inertial(index: int) -> bytes:
    """Return the inertial message of a sample."""
    values = {f'{axis}{name}': place + index / 100
              for place, axis in enumerate('xyz') for name in ('AngRate', 'Accel')}
    message = UBXMessage('ESF', 'ESF-INS', GET, version=1, iTOW=5 * index, **VALID, **values)
    return bytes(message.serialize())


def attitude(index: int) -> bytes:
    """Return the attitude message of a sample."""
    message = UBXMessage('NAV', 'NAV-ATT', GET, version=0, iTOW=5 * index, roll=index / 100,
                         pitch=index / 200, heading=30 + index / 100, accRoll=0.1, accPitch=0.1,
                         accHeading=0.2)
    return bytes(message.serialize())


def clock(index: int) -> bytes:
    """Return the time message of a sample."""
    message = UBXMessage('NAV', 'NAV-CLOCK', GET, iTOW=5 * index, clkB=index, clkD=2, tAcc=3,
                         fAcc=4)
    return bytes(message.serialize())


def count(data: bytes) -> int:
    """Return the count of intact messages."""
    stream = io.BufferedReader(io.BytesIO(data), CHUNK)
    reader = UBXReader(stream, protfilter=UBX_PROTOCOL, validate=VALCKSUM,
                       quitonerror=ERR_IGNORE)
    return sum(message is not None for _, message in reader)


if __name__ == '__main__':
    print_rate(count, mix(inertial, attitude, clock))
