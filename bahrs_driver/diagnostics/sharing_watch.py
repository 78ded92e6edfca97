# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Whether another program reads the same port, and so takes bytes from the driver.

The driver opens a port for itself alone, but who had it open before keeps it, and root may open
it at any time. The kernel gives each byte to one of the readers, so there is no error to see: a
read may find nothing, frames are damaged or lost, or nothing arrives at all. Only
then is /proc searched.
"""

from collections.abc import Callable
import os

from bahrs_driver.protocol.framing import FramingCounters
from bahrs_driver.transport.explain import described, list_command, MOST_NAMED
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.processes import holders, Process

MANY = 5                # damaged or lost frames between two checks that call for a look
LOOK_AGAIN = 3.0        # s, for a look may take a tenth of a second; doubled while in vain
LONGEST_WAIT = 60.0     # s
LIFETIME = 10.0         # s that a finding holds
ENOUGH_STOLEN = 3       # reads that found nothing, which prove it
TYPICAL_SIZE = 8        # bytes of a short frame, by which stray bytes count as frames


def count_trouble(counters: FramingCounters, lost: int) -> int:
    """Return about how many frames were damaged or lost, both of which a second reader causes."""
    return counters.crc_failures + counters.skipped_bytes // TYPICAL_SIZE + lost


class SharingWatch:
    """Looks for other readers of a link's port when there is a reason to."""

    def __init__(self, link: Link, trouble: Callable[[], int],
                 find: Callable[[str], list[Process]] = holders) -> None:
        """Watch a link; trouble returns how many frames were damaged or lost so far."""
        self._link = link
        self._trouble = trouble
        self._find = find
        self._counts = 0, 0
        self._stolen = 0                # reads that found nothing, lately
        self._looked = self._found = -LIFETIME
        self._wait = LOOK_AGAIN
        self._programs: list[Process] = []

    def check(self, now: float, silent: bool) -> None:
        """Look if there is a reason to, at a time of time.monotonic(); call it once a second."""
        counts = self._link.stolen, self._trouble()
        stolen, trouble = (max(0, new - old) for new, old in zip(counts, self._counts))
        self._counts = counts
        self._stolen += stolen
        if not (stolen or silent or trouble >= MANY):
            self._wait = max(LOOK_AGAIN, self._wait / 2)
        elif now - self._looked >= self._wait:
            self._look(now)

    def _look(self, now: float) -> None:
        self._looked = now
        self._wait = min(2 * self._wait, LONGEST_WAIT)
        device = os.path.realpath(self._link.path) if self._link.path else ''
        programs = [process for process in self._find(device)
                    if process.pid != os.getpid()] if device else []
        if programs or self._stolen >= ENOUGH_STOLEN:
            self._found, self._programs, self._wait = now, programs, LOOK_AGAIN
        self._stolen = 0

    def names(self, now: float) -> str:
        """Return the programs that have the port open, too; '' if none is known."""
        if now - self._found > LIFETIME:
            return ''
        names = ', '.join(map(described, self._programs[:MOST_NAMED]))
        return names or 'one of another user'

    def sentence(self, now: float) -> str:
        """Return what to do about another reader; '' if there is none."""
        names = self.names(now)
        return names and (f'another program is reading {self._link.name} and takes bytes from the '
                          f'driver ({names}): end it, {list_command(self._link.path)} lists all')
