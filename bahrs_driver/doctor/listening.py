# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which device speaks on a port, and how fast.

For a device that streams it is enough to listen, and nothing is written. A device that only
answers gets requests if the user wants that.
"""

from collections.abc import Generator, Mapping, Sequence
import shlex
import time
from typing import NamedTuple

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.doctor.commands import run_doctor, run_driver
from bahrs_driver.doctor.finding import Finding, good, problem
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.transport.link import Link, LinkError

BAUD_RATES = (115200, 921600, 460800, 230400, 57600, 38400, 19200, 9600)
LISTEN_TIME = 1.5           # s at each rate
ASK_EVERY = 0.3             # s
STREAMING, ANSWERING = False, True      # whether a device must be asked
ENOUGH_FRAMES = 20          # to be sure, without listening for so long


class Heard(NamedTuple):
    """What came at one rate: of the device that was recognised, or of none."""

    baud_rate: int
    bytes_received: int
    device: str = ''                # empty if there was no frame of any
    sensor: str = ''                # the parameter that goes with it
    frames: int = 0
    damaged: int = 0


def listen(port: str, baud_rate: int, seconds: float = LISTEN_TIME, ask: bool = False) -> Heard:
    """Return what comes on a port, asked for or not; LinkError if it cannot be opened."""
    formats = {name: spec.frame_format() for name, spec in DEVICES.items()}
    framers = {name: Framer(frame_format) for name, frame_format in formats.items()}
    requests = [request for spec in DEVICES.values() for request in spec.probe_requests]
    link = Link(port, baud_rate)
    link.connect()
    try:
        begin, asked = time.monotonic(), 0
        ended = False
        while not ended and not _enough(framers, asked):
            # Told before the read, which takes what came while a busy host did something else.
            ended = time.monotonic() >= begin + seconds
            if ask and requests and time.monotonic() >= begin + asked * ASK_EVERY:
                link.write(requests[asked % len(requests)])
                asked += 1
            reading = link.read()
            for framer in framers.values():
                framer.feed(reading.data if reading else b'')
    finally:
        link.close()
    sensor = max(framers, key=lambda name: framers[name].counters.frames)
    framer = framers[sensor]
    if not framer.counters.frames:
        return Heard(baud_rate, framer.received)
    device = DEVICES[sensor].describe(formats[sensor])
    return Heard(baud_rate, framer.received, device, sensor, framer.counters.frames,
                 framer.counters.crc_failures)


def _enough(framers: Mapping[str, Framer], asked: int) -> bool:
    return any(framer.counters.frames >= (
        max(1, asked // 2) if DEVICES[name].probe_requests else ENOUGH_FRAMES)
        for name, framer in framers.items())


def _labels(*kinds: bool) -> str:
    """Return the labels of all devices, or of those that stream or only answer."""
    return ' or '.join(spec.label for spec in DEVICES.values()
                       if bool(spec.probe_requests) in (kinds or (STREAMING, ANSWERING)))


def look(port: str, asked_rate: int, seconds: float = LISTEN_TIME, ask: bool = False,
         rates: Sequence[int] = BAUD_RATES) -> Generator[Finding, None, Heard | None]:
    """
    Yield which device speaks, at the rate that is asked for or else at which other.

    The generator returns what was heard, if a device was recognised.
    """
    try:
        first = listen(port, asked_rate, seconds, ask)
        if first.device:
            yield _described(first)
            return first
        if not first.bytes_received and not ask:
            yield problem('device', f'nothing arrives on {port}: a {_labels(STREAMING)} streams, '
                                    'so check its power and the line from its output; a '
                                    f'{_labels(ANSWERING)} must be asked',
                          run_doctor(port, asked_rate, ask=True))
            return None
        for rate in rates:
            if rate != asked_rate and (heard := listen(port, rate, seconds, ask)).device:
                yield problem('device', f'a {heard.device} speaks at {rate} baud, not at '
                                        f'{asked_rate}',
                              run_driver(port, heard.sensor, rate))
                yield _described(heard)
                return heard
    except (LinkError, ValueError) as error:
        yield problem('device', f'cannot listen: {error}', run_doctor(port, asked_rate))
        return None
    if not first.bytes_received:
        yield problem('device', f'nothing arrives on {port}, though a {_labels(ANSWERING)} was '
                                'asked at all usual rates: check its power and both lines, then '
                                'ask again',
                      run_doctor(port, asked_rate, ask=True))
        return None
    yield problem('device', f'{first.bytes_received:,} bytes arrive at {asked_rate} baud, but no '
                            f'frame of a {_labels()}, at no usual rate: it is another device, '
                            'or the line is inverted or noisy; look at the bytes',
                  f'stty -F {shlex.quote(port)} {asked_rate} raw && '
                  f'timeout 1 xxd {shlex.quote(port)} | head')
    return None


def _described(heard: Heard) -> Finding:
    verb = 'answers' if DEVICES[heard.sensor].probe_requests else 'sends'
    damage = f', {heard.damaged} damaged' if heard.damaged else ', none damaged'
    return good('device', f'a {heard.device} {verb} at {heard.baud_rate} baud: {heard.frames} '
                          f'frames{damage}')
