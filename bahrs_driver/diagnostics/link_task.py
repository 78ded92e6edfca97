# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Link*: whether the port is open, and bytes come."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.sharing_watch import SharingWatch
from bahrs_driver.diagnostics.task import ago, ERROR, OK, Verdict
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.receiver import LinkCounters
from bahrs_driver.units import BITS_PER_BYTE


class LinkTask:
    """Watches the port."""

    name = 'Link'

    def __init__(self, link: Link, counters: LinkCounters, silence_timeout: float,
                 silence_hint: str, trouble: Callable[[], int]) -> None:
        """
        Watch a link; it is silent after silence_timeout seconds without a byte.

        silence_hint is the remedy for a silent link. trouble returns how many frames
        were damaged or lost so far, which may be the work of another program.
        """
        self._link = link
        self._counters = counters
        self._silence_timeout = silence_timeout
        self._silence_hint = silence_hint
        self._sharing = SharingWatch(link, trouble)
        self._window = Window(lambda: (counters.bytes_received,))

    def judge(self, now: float) -> Verdict:
        """Return whether the port is open and bytes arrive."""
        counters, port = self._counters, self._link.name
        open_since = counters.open_since        # once: the receiver's thread may close it now
        if open_since is None:
            return Verdict(ERROR, counters.error or f'{port} is not open yet')
        if self._silent(open_since, now):
            return Verdict(ERROR, f'{port} is open but silent: {self._silence_hint}'
                                  f'{self._what_else(now)}')
        sharing = self._sharing.sentence(now)
        return Verdict(ERROR, sharing) if sharing else Verdict(OK, f'{port} is open')

    def _what_else(self, now: float) -> str:
        """Return what else is known of a silent port, after the end of the hint."""
        stop = '' if self._silence_hint.endswith(('?', '.')) else '.'
        if self._link.is_network:
            return f'{stop} The connection to the serial server is up.'
        names = self._sharing.names(now)
        return names and f'{stop} Another program has it open, too ({names}).'

    def check_sharing(self, now: float) -> None:
        """Look for other programs that read the port, which takes a while; call it at 1 Hz."""
        open_since = self._counters.open_since
        if open_since is not None:
            self._sharing.check(now, self._silent(open_since, now))

    def _silent(self, open_since: float, now: float) -> bool:
        return now - max(open_since, self._counters.last_data or 0.0) > self._silence_timeout

    def values(self, now: float) -> Mapping[str, str]:
        """Return port, traffic and errors."""
        counters, baud_rate = self._counters, self._link.baud_rate
        elapsed, (received,) = self._window.growth(now)
        rate = received / elapsed if elapsed else 0.0
        open_since = counters.open_since
        return {
            'Port': self._link.name,
            'Baud rate': str(baud_rate),
            'Open for [s]': 'not open' if open_since is None else ago(open_since, now),
            'Times opened': str(counters.times_opened),
            'Bytes received': str(counters.bytes_received),
            'Bytes per second': f'{rate:.0f}',
            'Use of the line': f'{rate * BITS_PER_BYTE / baud_rate:.0%}',
            'Last data [s ago]': ago(counters.last_data, now),
            'Last error': counters.last_error or 'none',
        }
