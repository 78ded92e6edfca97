# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Link*: whether the port is open and bytes arrive."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.sharing_watch import bad_frames, SharingWatch
from bahrs_driver.diagnostics.task import ERROR, OK, seconds_ago, Status, Template
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.pipeline import PipelineCounters
from bahrs_driver.transport.explain import CAUSES
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_reader import LinkCounters
from bahrs_driver.units import BITS_PER_BYTE

NOT_OPEN = Template(ERROR, '{port} is not open yet')
FAILED = Template(ERROR, '{reason}')
SILENT = Template(ERROR, '{port} is open but silent: {hint}', 'a silent device')
SHARED = Template(ERROR, 'another program is reading {port} and takes bytes from the driver '
                         '({programs}): end it; {command} lists all',
                  'another program takes bytes')
OPEN = Template(OK, '{port} is open')


class LinkTask:
    """
    Watches the port.

    The port is silent after silence_timeout seconds without a byte; silence_hint is what to check
    then. Damaged frames, in the stream's counters, and lost messages, which count_lost returns,
    may be a sign of another program that reads the port.
    """

    name = 'Link'
    messages = (SHARED, SILENT, *(Template(ERROR, text, cause) for cause, text in CAUSES.items()),
                FAILED, NOT_OPEN, OPEN)

    def __init__(self, link: Link, counters: LinkCounters, stream: PipelineCounters,
                 silence_timeout: float, silence_hint: str,
                 count_lost: Callable[[], int]) -> None:
        self._link = link
        self._counters = counters
        self._stream = stream
        self._silence_timeout = silence_timeout
        self._silence_hint = silence_hint
        self._sharing = SharingWatch(link, lambda: bad_frames(stream.framing, count_lost()))
        self._window = Window(lambda: (stream.bytes_received,))

    def run(self, status: Status) -> Status:
        """Report whether the port is open and bytes arrive."""
        status.values_from(self._values)
        port = self._link.name
        # The reading thread may change them meanwhile.
        open_since, error = self._counters.open_since, self._counters.error
        if open_since is None:
            return status.summary(FAILED if error else NOT_OPEN, reason=error, port=port)
        if self._silent(open_since, status.now):
            return status.summary(SILENT, port=port, hint=self._hint(status.now))
        programs = self._sharing.describe_programs(status.now)
        if programs:
            return status.summary(SHARED, port=port, programs=programs,
                                  command=self._sharing.command)
        return status.summary(OPEN, port=port)

    def check_sharing(self, now: float) -> None:
        """Search for other programs that read the port, which is slow; call it once a second."""
        open_since = self._counters.open_since
        if open_since is not None:
            self._sharing.check(now, self._silent(open_since, now))

    def _hint(self, now: float) -> str:
        """Return what to check on a silent port, and what is known about it."""
        hint = self._silence_hint
        stop = '' if hint.endswith(('?', '.')) else '.'
        if self._link.is_network:
            return f'{hint}{stop} The connection to the serial server is up.'
        programs = self._sharing.describe_programs(now)
        return f'{hint}{stop} Another program has it open, too ({programs}).' if programs else hint

    def _silent(self, open_since: float, now: float) -> bool:
        return now - max(open_since, self._counters.last_data or 0.0) > self._silence_timeout

    def _values(self, now: float) -> Mapping[str, str]:
        counters, baud_rate = self._counters, self._link.baud_rate
        elapsed, (received,) = self._window.growth(now)
        rate = received / elapsed if elapsed else 0.0
        open_since = counters.open_since
        return {
            'Port': self._link.name,
            'Baud rate': str(baud_rate),
            'Open for [s]': 'not open' if open_since is None else seconds_ago(open_since, now),
            'Times opened': str(counters.times_opened),
            'Bytes received': str(self._stream.bytes_received),
            'Bytes per second': f'{rate:.0f}',
            'Use of the line': f'{rate * BITS_PER_BYTE / baud_rate:.0%}',
            'Last data [s ago]': seconds_ago(counters.last_data, now),
            'Last error': counters.last_error or 'none',
        }
