# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find out whether another program reads the same port and takes bytes from the driver.

The driver opens a port exclusively, but a program that had it open before keeps it, and root may
open it at any time. The kernel gives each byte to one of the readers, and reports no error: a
read may find nothing, frames are damaged or lost, or nothing arrives at all. Only these signs
start a search of /proc.
"""

from collections.abc import Callable
import os

from bahrs_driver.protocol.framing import FramingCounters
from bahrs_driver.transport.explain import describe_process, list_command, MOST_NAMED
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.processes import holders, Process

MIN_BAD_FRAMES = 5      # damaged or lost since the previous check that start a search
SEARCH_PERIOD = 3.0     # s; a search may take 0.1 s. Doubled after each search without a result
LONGEST_PERIOD = 60.0   # s
LIFETIME = 10.0         # s for which a result is shown
ENOUGH_STOLEN = 3       # reads without bytes that prove another reader
TYPICAL_SIZE = 8        # bytes of a short frame: as many stray bytes count as one frame


def bad_frames(counters: FramingCounters, lost: int) -> int:
    """Estimate how many frames were damaged or lost: another reader causes both."""
    return counters.crc_failures + counters.skipped_bytes // TYPICAL_SIZE + lost


class SharingWatch:
    """
    Searches for other readers of a link's port if there is a sign of one.

    count_bad_frames returns how many frames were damaged or lost so far.
    """

    def __init__(self, link: Link, count_bad_frames: Callable[[], int],
                 find: Callable[[str], list[Process]] = holders) -> None:
        self._link = link
        self._count_bad_frames = count_bad_frames
        self._find = find
        self._counts = 0, 0             # at the previous check: stolen reads, bad frames
        self._stolen = 0                # reads without bytes since the previous search
        self._searched_at = self._found_at = -LIFETIME
        self._period = SEARCH_PERIOD
        self._programs: list[Process] = []

    @property
    def command(self) -> str:
        """Command that lists the programs that have the port open."""
        return list_command(self._link.path)

    def check(self, now: float, silent: bool) -> None:
        """Search if there is a sign, at a time of time.monotonic(); call it once a second."""
        counts = self._link.stolen, self._count_bad_frames()
        stolen, bad = (max(0, new - old) for new, old in zip(counts, self._counts))
        self._counts = counts
        self._stolen += stolen
        if not (stolen or silent or bad >= MIN_BAD_FRAMES):
            self._period = max(SEARCH_PERIOD, self._period / 2)
        elif now - self._searched_at >= self._period:
            self._search(now)

    def describe_programs(self, now: float) -> str:
        """Describe the other programs that have the port open; '' if none was found lately."""
        if now - self._found_at > LIFETIME:
            return ''
        names = ', '.join(map(describe_process, self._programs[:MOST_NAMED]))
        return names or 'one of another user'

    def _search(self, now: float) -> None:
        self._searched_at = now
        self._period = min(2 * self._period, LONGEST_PERIOD)
        device = os.path.realpath(self._link.path) if self._link.path else ''
        programs = [process for process in self._find(device)
                    if process.pid != os.getpid()] if device else []
        if programs or self._stolen >= ENOUGH_STOLEN:
            self._found_at, self._programs, self._period = now, programs, SEARCH_PERIOD
        self._stolen = 0
