# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The device on a port whose memory `bahrs nvm` reads."""

from collections.abc import Callable, Iterator
import contextlib
import threading

from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.errors import CommandError
from bahrs_driver.pipeline import DecodingFault, Event, Stamped
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_events import (
    BytesRead, PortEvent, PortOpened, PortUnavailable, StreamEnded,
)
from bahrs_driver.transport.port_reader import PortReader

OPEN_TIMEOUT = 30.0     # s


class NvmDevice:
    """A device on a port, with one thread that reads the port and one that writes requests."""

    def __init__(self, spec: AnyDevice, link: Link, log_error: Callable[[str], None]) -> None:
        pipeline, self.nvm = spec.memory_access(link)
        self._link = link
        self._failure = ''
        self._faults = FaultLog(log_error, str)
        self._reader = PortReader(link, pipeline, self._faults)
        self._sample_types = spec.roles.sample if spec.roles else ()
        self._opened_or_failed = threading.Event()
        self._sample_received = threading.Event()

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Run the threads during a block."""
        threads = [threading.Thread(target=self._read, name='reader'),
                   threading.Thread(target=self.nvm.loop.run, name='requests')]
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._reader.stop()
            self.nvm.loop.stop()
            for thread in threads:
                thread.join()

    def is_streaming(self, timeout: float) -> bool:
        """Wait until the port is open; return whether a sample arrives within timeout seconds."""
        if not self._opened_or_failed.wait(OPEN_TIMEOUT):
            raise CommandError(f'{self._link.name} could not be opened within '
                               f'{OPEN_TIMEOUT:g} s: check other programs and the network')
        if self._failure:
            raise CommandError(self._failure)
        return self._sample_received.wait(timeout)

    def _read(self) -> None:
        for event in self._reader.events():
            self._faults.survive('handling an event of the port', self._handle, event)

    def _handle(self, event: PortEvent) -> None:
        if isinstance(event, PortOpened):
            self._opened_or_failed.set()
        elif isinstance(event, PortUnavailable):
            self._failure = event.reason
            self._opened_or_failed.set()
            self.nvm.abandon(event.reason)
        elif isinstance(event, (BytesRead, StreamEnded)):
            for item in event.events or ():
                self._receive(item)

    def _receive(self, item: Event) -> None:
        if isinstance(item, DecodingFault):
            self._faults.report('decoding a frame', item.error)
        elif isinstance(item, Stamped):
            if isinstance(item.message, self._sample_types):
                self._sample_received.set()
            self.nvm.receive(item.message, item.frame)
