# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the counters mean, as diagnostic_msgs that say what to do (REP-107).

A Monitor is asked once a second; it judges what happened since it was asked before.
"""

from collections.abc import Callable, Mapping
import time

from bahrs_driver.link import Link
from bahrs_driver.protocol.framing import Framer, FramingCounters
from bahrs_driver.receiver import LinkCounters, Receiver
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR

SILENCE = 1.0                   # s without a byte before a link is called silent
WARN_FAILED = 0.0               # share of frames with a bad checksum above which to warn
ERROR_FAILED = 0.1              # and above which the line is called unusable

_PREFIX = 'bahrs_driver: '
Verdict = tuple[bytes, str]


class Monitor:
    """Judges the link and the frames on it."""

    def __init__(self, link: Link, receiver: Receiver, framer: Framer,
                 protocol: Callable[[], Mapping[str, str]],
                 clock: Callable[[], float] = time.monotonic) -> None:
        """Take what is to be watched, and a clock in seconds."""
        self._link = link
        self._receiver = receiver
        self._framer = framer
        self._protocol = protocol
        self._clock = clock
        self._before = self._after = self._snapshot()

    def update(self) -> None:
        """Begin the next interval; what is judged is the one that ends now."""
        self._before, self._after = self._after, self._snapshot()

    def statuses(self) -> list[DiagnosticStatus]:
        """Return the present state, one status a task."""
        return [self._link_status(), self._framing_status()]

    def _snapshot(self) -> tuple[float, int, int, int, int]:
        framing = self._framer.counters
        return (self._clock(), self._receiver.counters.bytes_received,
                framing.frames, framing.crc_failures, framing.skipped_bytes)

    def _link_status(self) -> DiagnosticStatus:
        counters, now = self._receiver.counters, self._clock()
        elapsed, received, *_ = self._interval()
        rate = received / elapsed if elapsed else 0.0
        level, message = judge_link(counters, now, self._link.port)
        values = {
            'Port': self._link.port,
            'Baud rate': str(self._link.baud_rate),
            'Open for [s]': _since(counters.open_since, now),
            'Times opened': str(counters.times_opened),
            'Bytes received': str(counters.bytes_received),
            'Bytes per second': f'{rate:.0f}',
            'Last data [s ago]': _since(counters.last_data, now),
            'Last error': counters.last_error or 'none',
        }
        return self._status('Link', level, message, values)

    def _framing_status(self) -> DiagnosticStatus:
        framing = self._framer.counters
        _, received, frames, failures, skipped = self._interval()
        level, message = judge_framing(received, frames, failures, skipped, self._link.baud_rate)
        values = {
            **self._protocol(),
            'Frames': str(framing.frames),
            'CRC failures': str(framing.crc_failures),
            'Skipped bytes': str(framing.skipped_bytes),
            'Frames of unknown type': _unknown_types(framing),
        }
        return self._status('Framing', level, message, values)

    def _interval(self) -> tuple[float, int, int, int, int]:
        before, after = self._before, self._after
        return (after[0] - before[0], after[1] - before[1], after[2] - before[2],
                after[3] - before[3], after[4] - before[4])

    def _status(self, task: str, level: bytes, message: str,
                values: Mapping[str, str]) -> DiagnosticStatus:
        return DiagnosticStatus(
            level=level, name=_PREFIX + task, message=message, hardware_id=self._link.port,
            values=[KeyValue(key=key, value=value) for key, value in values.items()])


def judge_link(counters: LinkCounters, now: float, port: str) -> Verdict:
    """Return level and message for the state of the port; now is in seconds."""
    if counters.open_since is None:
        return ERROR, counters.error or f'{port} is not open yet'
    last = max(counters.open_since, counters.last_data or 0.0)
    if now - last > SILENCE:
        return ERROR, (f'{port} is open but silent for {now - last:.0f} s: '
                       'is the device powered and its line connected?')
    return OK, f'{port} is open'


def judge_framing(received: int, frames: int, failures: int, skipped: int,
                  baud_rate: int) -> Verdict:
    """Return level and message for the bytes, frames and errors of one interval."""
    if not received:
        return OK, 'Nothing received'
    if not frames:
        return ERROR, (f'Bytes arrive but no frames: is {baud_rate} the baud rate of the device, '
                       'and is it the sensor that the parameter says?')
    share = failures / (failures + frames)
    if share > ERROR_FAILED:
        return ERROR, f'{share:.0%} of the frames are damaged: check cable, ground and baud rate'
    if share > WARN_FAILED or skipped:
        return WARN, f'{failures} damaged frames and {skipped} stray bytes in the last second'
    return OK, 'All frames intact'


def _since(moment: float | None, now: float) -> str:
    return 'never' if moment is None else f'{now - moment:.1f}'


def _unknown_types(framing: FramingCounters) -> str:
    counts = sorted(framing.unknown_types.items())
    return ', '.join(f'{name}: {count}' for name, count in counts) or 'none'
