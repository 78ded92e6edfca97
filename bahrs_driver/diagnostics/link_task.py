# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Link*: whether the port is open, and bytes come."""

from collections.abc import Mapping

from bahrs_driver.clock import BITS_PER_BYTE
from bahrs_driver.diagnostics.task import ago, ERROR, OK, Verdict
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.link import Link
from bahrs_driver.receiver import LinkCounters


class LinkTask:
    """Watches the port."""

    name = 'Link'

    def __init__(self, link: Link, counters: LinkCounters, silence_timeout: float) -> None:
        """Watch a link; it is called silent after silence_timeout seconds without a byte."""
        self._link = link
        self._counters = counters
        self._silence_timeout = silence_timeout
        self._window = Window(lambda: (counters.bytes_received,))

    def judge(self, now: float) -> Verdict:
        """Return whether the port is open and not silent."""
        counters, port = self._counters, self._link.port
        if counters.open_since is None:
            return Verdict(ERROR, counters.error or f'{port} is not open yet')
        silence = now - max(counters.open_since, counters.last_data or 0.0)
        if silence > self._silence_timeout:
            return Verdict(ERROR, f'{port} is open but silent: is the device powered, and is its '
                                  'line connected?')
        return Verdict(OK, f'{port} is open')

    def values(self, now: float) -> Mapping[str, str]:
        """Return port, traffic and errors."""
        counters, baud_rate = self._counters, self._link.baud_rate
        elapsed, (received,) = self._window.growth(now)
        rate = received / elapsed if elapsed else 0.0
        return {
            'Port': self._link.port,
            'Baud rate': str(baud_rate),
            'Open for [s]': 'not open' if counters.open_since is None
            else ago(counters.open_since, now),
            'Times opened': str(counters.times_opened),
            'Bytes received': str(counters.bytes_received),
            'Bytes per second': f'{rate:.0f}',
            'Use of the line': f'{rate * BITS_PER_BYTE / baud_rate:.0%}',
            'Last data [s ago]': ago(counters.last_data, now),
            'Last error': counters.last_error or 'none',
        }
