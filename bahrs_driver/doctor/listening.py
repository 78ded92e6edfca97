# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Which device speaks on a port, and how fast. Only listens: nothing is ever written."""

from collections.abc import Iterator, Sequence
import time
from typing import NamedTuple

from bahrs_driver.doctor.finding import Finding, good, problem
from bahrs_driver.link import Link, LinkError
from bahrs_driver.protocol.bahrs_frames import BahrsFormat
from bahrs_driver.protocol.framing import Framer

BAUD_RATES = (115200, 921600, 460800, 230400, 57600, 38400, 19200, 9600)
LISTEN_TIME = 1.5           # s at each rate
ENOUGH_FRAMES = 20          # to be sure, without listening for so long


class Heard(NamedTuple):
    """What came at one rate."""

    baud_rate: int
    bytes_received: int
    frames: int
    damaged: int
    version: int | None


def listen(port: str, baud_rate: int, seconds: float = LISTEN_TIME) -> Heard:
    """Return what comes on a port; LinkError if it cannot be opened."""
    frame_format = BahrsFormat()
    framer = Framer(frame_format)
    link = Link(port, baud_rate)
    link.connect()
    try:
        end = time.monotonic() + seconds
        while time.monotonic() < end and framer.counters.frames < ENOUGH_FRAMES:
            reading = link.read()
            if reading:
                framer.feed(reading.data)
    finally:
        link.close()
    return Heard(baud_rate, framer.received, framer.counters.frames,
                 framer.counters.crc_failures, frame_format.version_seen)


def look(port: str, asked_rate: int, seconds: float = LISTEN_TIME,
         rates: Sequence[int] = BAUD_RATES) -> Iterator[Finding]:
    """Yield which device speaks, at the rate that is asked for or else at which other."""
    try:
        first = listen(port, asked_rate, seconds)
        if first.frames:
            yield _described(first)
            return
        if not first.bytes_received:
            yield problem('device', f'nothing arrives on {port}: a BAHRS sends by itself, so look '
                                    'at its power and at the line from its output, then listen '
                                    'again', f'bahrs doctor --port {port}')
            return
        for rate in rates:
            if rate != asked_rate and (heard := listen(port, rate, seconds)).frames:
                yield problem('device', f'a BAHRS speaks at {rate} baud, not at {asked_rate}',
                              'ros2 run bahrs_driver driver_node --ros-args -p '
                              f'port:={port} -p baud_rate:={rate}')
                yield _described(heard)
                return
    except (LinkError, ValueError) as error:
        yield problem('device', f'cannot listen: {error}', f'bahrs doctor --port {port}')
        return
    yield problem('device', f'{first.bytes_received:,} bytes arrive at {asked_rate} baud, but no '
                            'frame of a BAHRS, at no usual rate: it is another device, or the '
                            'line is inverted or noisy; look at the bytes',
                  f'stty -F {port} {asked_rate} raw && timeout 1 xxd {port} | head')


def _described(heard: Heard) -> Finding:
    damage = f', {heard.damaged} damaged' if heard.damaged else ', none damaged'
    return good('device', f'a BAHRS of protocol version {heard.version} sends at '
                          f'{heard.baud_rate} baud: {heard.frames} frames{damage}')
