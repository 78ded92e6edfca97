# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Detect the device on a port, and its baud rate.

A device that sends by itself is detected by listening. A device that only answers is detected by
requests, which are sent only if the user permits it.
"""

from collections.abc import Generator, Sequence
import shlex
import time
from typing import NamedTuple

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.doctor.check_result import CheckResult, ok, problem
from bahrs_driver.doctor.commands import run_doctor, run_driver
from bahrs_driver.errors import LinkError
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.transport.link import Link

BAUD_RATES = (115200, 921600, 460800, 230400, 57600, 38400, 19200, 9600)
LISTEN_TIME = 1.5           # s at each rate
REQUEST_PERIOD = 0.3        # s
ENOUGH_FRAMES = 20          # frames that prove a device before LISTEN_TIME is over


class ProbeResult(NamedTuple):
    """What arrived at one baud rate."""

    baud_rate: int
    bytes_received: int
    device: str = ''                # description of the device; empty if none was recognized
    sensor: str = ''                # its value of the parameter sensor
    frames: int = 0
    damaged: int = 0


def probe(port: str, baud_rate: int, seconds: float = LISTEN_TIME,
          ask: bool = False) -> ProbeResult:
    """Listen on a port, and send requests if ask is true; LinkError if it cannot be opened."""
    formats = {name: spec.frame_format() for name, spec in DEVICES.items()}
    framers = {name: Framer(frame_format) for name, frame_format in formats.items()}
    requests = [request for spec in DEVICES.values() for request in spec.probe_requests]
    link = Link(port, baud_rate)
    link.connect()
    try:
        begin, attempts = time.monotonic(), 0
        ended = False
        while not ended and not any(_proven(name, framer.counters.frames, attempts)
                                    for name, framer in framers.items()):
            # Before the read: on a busy host, it returns bytes that arrived in time.
            ended = time.monotonic() >= begin + seconds
            if ask and requests and time.monotonic() >= begin + attempts * REQUEST_PERIOD:
                link.write(requests[attempts % len(requests)])
                attempts += 1
            reading = link.read()
            for framer in framers.values():
                framer.feed(reading.data if reading else b'')
    finally:
        link.close()
    sensor = max(framers, key=lambda name: framers[name].counters.frames)
    framer = framers[sensor]
    if not framer.counters.frames:
        return ProbeResult(baud_rate, framer.received)
    return ProbeResult(baud_rate, framer.received, DEVICES[sensor].describe(formats[sensor]),
                       sensor, framer.counters.frames, framer.counters.crc_failures)


def _proven(sensor: str, frames: int, attempts: int) -> bool:
    return frames >= (max(1, attempts // 2) if _answers(sensor) else ENOUGH_FRAMES)


def _answers(sensor: str) -> bool:
    """Return whether a device only answers requests."""
    return bool(DEVICES[sensor].probe_requests)


def check(port: str, expected_rate: int, seconds: float = LISTEN_TIME, ask: bool = False,
          rates: Sequence[int] = BAUD_RATES) -> Generator[CheckResult, None, ProbeResult | None]:
    """
    Check which device sends at the expected baud rate, or else at another.

    The generator returns the result of the probe that recognized a device, if any.
    """
    try:
        expected = probe(port, expected_rate, seconds, ask)
        if expected.device:
            yield _recognized(expected)
            return expected
        if not expected.bytes_received and not ask:
            yield _silent(port, expected_rate)
            return None
        for rate in rates:
            if rate != expected_rate and (found := probe(port, rate, seconds, ask)).device:
                yield problem('device', f'a {found.device} sends at {rate} baud, not at '
                                        f'{expected_rate}', run_driver(port, found.sensor, rate))
                yield _recognized(found)
                return found
    except (LinkError, ValueError) as error:
        yield problem('device', f'cannot listen: {error}', run_doctor(port, expected_rate))
        return None
    yield _unrecognized(port, expected)
    return None


def _silent(port: str, baud_rate: int) -> CheckResult:
    return problem('device', f'nothing arrives on {port}: a {_labels(answers=False)} sends by '
                             'itself, so check its power and the line from its output; a '
                             f'{_labels(answers=True)} must be asked',
                   run_doctor(port, baud_rate, ask=True))


def _unrecognized(port: str, found: ProbeResult) -> CheckResult:
    rate = found.baud_rate
    if not found.bytes_received:
        return problem('device', f'nothing arrives on {port}, though a {_labels(answers=True)} '
                                 'was asked at all usual rates: check its power and both lines, '
                                 'then ask again', run_doctor(port, rate, ask=True))
    labels = ' or '.join(spec.label for spec in DEVICES.values())
    return problem('device', f'{found.bytes_received:,} bytes arrive at {rate} baud, but no frame '
                             f'of a {labels}, at no usual rate: it is another device, or the line '
                             'is inverted or noisy; look at the bytes',
                   f'stty -F {shlex.quote(port)} {rate} raw && '
                   f'timeout 1 xxd {shlex.quote(port)} | head')


def _labels(answers: bool) -> str:
    return ' or '.join(spec.label for name, spec in DEVICES.items() if _answers(name) is answers)


def _recognized(found: ProbeResult) -> CheckResult:
    verb = 'answers' if _answers(found.sensor) else 'sends'
    damage = f'{found.damaged} damaged' if found.damaged else 'none damaged'
    return ok('device', f'a {found.device} {verb} at {found.baud_rate} baud: {found.frames} '
                        f'frames, {damage}')
