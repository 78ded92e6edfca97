# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of sessions on a link that another thread reads."""

import contextlib
import gc
import queue
import threading
import time
import tracemalloc

from bahrs_driver.devices.nvm_reader import NvmReader
from bahrs_driver.devices.nvm_settings import NvmSettings
from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceBehavior
from bahrs_driver.errors import LinkError, NvmError
from bahrs_driver.protocol.bahrs import nvm_session
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import NvmPage
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.transport.request_loop import RequestLoop
import pytest
from support.waiting import wait_for

IMAGE = bytes(index * 13 % 256 for index in range(8000))
LONG = 60.0             # s; limit for events that follow at once
NS = 10 ** 9
PATIENT = NvmSettings(enter_timeout=LONG)


class Device:
    """A link with a device at its end; one thread hands in its answers, in order."""

    def __init__(self, **behavior):
        """Answer at once, until silent is set."""
        self._mode = DiagnosticsMode(ServiceBehavior(image=IMAGE, timeout=LONG, **behavior))
        self._codec = BahrsCodec()
        self._answers = queue.Queue()
        self._receiver = threading.Thread(target=self._receive)
        self.loop = RequestLoop(self)
        self._sender = threading.Thread(target=self.loop.run)
        self.reader = NvmReader(self.loop, lambda: 3)
        self.silent = False
        self.broken = False
        self.pages_sent = 0

    def _receive(self):
        for answer in iter(self._answers.get, None):
            self.pages_sent += isinstance(answer[0], NvmPage)
            self.reader.receive(*answer)

    def __enter__(self):
        """Start both threads."""
        self._receiver.start()
        self._sender.start()
        return self

    def __exit__(self, *_):
        """Stop both threads."""
        self.loop.stop()
        self._sender.join()
        self._answers.put(None)
        self._receiver.join()

    def write(self, data, _wait=True):
        """Receive bytes of the host."""
        if self.broken:
            raise LinkError('the port is gone')
        if self.silent:
            return
        for message in self._mode.receive(data, time.monotonic()):
            frame = Frame(0, self._codec.encode(message, 3), 'crc32')
            self._answers.put((message, frame))

    @property
    def active(self):
        """Whether the device is in diagnostics mode."""
        return self._mode.active(time.monotonic())


@pytest.fixture
def made():
    """Give a function that makes a device."""
    with contextlib.ExitStack() as stack:
        yield lambda **behavior: stack.enter_context(Device(**behavior))


@pytest.fixture
def in_background():
    """Give a function that reads all pages in another thread, and waits for it at the end."""
    threads = []

    def start(device):
        result = {}

        def work():
            try:
                result['pages'] = device.reader.read(settings=PATIENT)
            except NvmError as error:
                result['error'] = str(error)
        threads.append(threading.Thread(target=work))
        threads[-1].start()
        assert wait_for(lambda: device.reader.status != 'none')
        return result, threads[-1]

    yield start
    for thread in threads:
        thread.join()


def test_pages(made):
    """By number."""
    device = made()
    assert device.reader.read([3, 249]) == {3: IMAGE[96:128], 249: IMAGE[-32:]}
    assert not device.active and device.reader.status == 'none'


def test_each_page_is_delivered_when_it_is_read(made):
    """In order, and those before a failure, too."""
    device, pages, progress = made(error_pages=frozenset({3})), [], []
    write = device.write

    def write_after_delivery(data, _wait=True):
        # The requests after a page was read wait for its delivery.
        assert wait_for(lambda: len(pages) >= device.pages_sent)
        write(data)

    device.write = write_after_delivery
    with pytest.raises(NvmError, match='cannot read page 3'):
        device.reader.read(range(5), on_page=lambda *page: pages.append(page),
                           on_progress=lambda session: progress.append(session.progress))
    assert pages == [(number, IMAGE[32 * number:32 * number + 32]) for number in range(3)]
    assert {0.2, 0.4, 0.6} <= set(progress)


def test_an_exception_of_the_callback_ends_the_session(made):
    """The device leaves its mode, and the caller gets the exception."""
    device = made()

    def fail(*_):
        raise ValueError('no longer')

    with pytest.raises(ValueError, match='no longer'):
        device.reader.read([0, 1], on_page=fail)
    assert not device.active and device.reader.status == 'none'


def test_the_thread_that_reads_never_waits(made, in_background):
    """Neither for a slow link nor for a slow callback."""
    device, entered, go_on = made(), threading.Event(), threading.Event()

    def wait(*_):
        entered.set()
        go_on.wait(LONG)

    reading = threading.Thread(target=lambda: device.reader.read([0], on_page=wait))
    reading.start()
    assert entered.wait(LONG)
    receiver = threading.Thread(target=lambda: device.reader.receive(None, Frame(0, b'', '')))
    receiver.start()
    receiver.join(LONG)
    assert not receiver.is_alive()
    go_on.set()
    reading.join()

    device, entered, go_on = made(), threading.Event(), threading.Event()
    device.write = wait
    _, reading = in_background(device)
    assert entered.wait(LONG)
    receiver = threading.Thread(target=lambda: device.reader.receive(None, Frame(0, b'', '')))
    receiver.start()
    receiver.join(LONG)
    assert not receiver.is_alive()
    device.reader.end('over', 0.0)
    go_on.set()
    reading.join()


def test_the_end_waits_for_the_device_to_leave(made, in_background):
    """The caller gets the reason; no session may begin afterwards."""
    device = made()
    result, thread = in_background(device)
    assert wait_for(lambda: device.active)
    device.reader.end('the driver is ending', LONG)
    assert not device.active and device.reader.status == 'none'
    thread.join()
    assert result == {'error': 'the driver is ending'}
    with pytest.raises(NvmError, match='the driver is ending'):
        device.reader.read([0])


def test_the_end_does_not_wait_for_a_silent_device(made, in_background):
    """Nor for a link that accepts nothing."""
    for link in ('silent', 'broken'):
        device = made()
        setattr(device, link, True)
        result, thread = in_background(device)
        begin = time.monotonic()
        device.reader.end('the driver is ending')
        thread.join()
        assert time.monotonic() - begin < nvm_session.LOSS_TIME / NS
        assert result == {'error': 'the driver is ending'}


def test_failure_has_its_reason(made):
    """The next request is carried out."""
    device = made(error_pages=frozenset({1}))
    with pytest.raises(NvmError, match='cannot read page 1'):
        device.reader.read([1])
    assert device.reader.read([2]) == {2: IMAGE[64:96]}


def test_only_one_at_a_time(made, in_background):
    """The second is refused at once; the first continues until it is cancelled."""
    device = made()
    device.silent = True
    result, thread = in_background(device)
    with pytest.raises(NvmError, match='another NVM request is under way'):
        device.reader.read([0])
    assert device.reader.status == 'asking the device to enter diagnostics mode'
    assert device.reader.cancel()
    thread.join()
    assert result == {'error': 'cancelled'}
    assert not device.reader.cancel() and device.reader.status == 'none'


def test_lost_link(made, in_background):
    """The caller gets the reason at once."""
    device = made()
    device.silent = True
    result, thread = in_background(device)
    device.reader.abandon('/dev/ttyUSB0 is gone')
    thread.join()
    assert result == {'error': '/dev/ttyUSB0 is gone'}


def test_a_write_that_fails_before_its_link_is_known_to_be_lost(made, in_background, monkeypatch):
    """The reason is that of the thread that reads, which includes a remedy."""
    monkeypatch.setattr(nvm_session, 'LOSS_TIME', round(LONG * NS))
    device = made()
    device.broken = True
    result, thread = in_background(device)
    device.reader.abandon('/dev/ttyUSB0 is gone: plug it in again')
    thread.join()
    assert result == {'error': '/dev/ttyUSB0 is gone: plug it in again'}


def test_link_that_accepts_no_data(made, monkeypatch):
    """The reason is that of the link."""
    monkeypatch.setattr(nvm_session, 'LOSS_TIME', round(0.01 * NS))
    device = made()
    device.broken = True
    with pytest.raises(NvmError, match='the port is gone'):
        device.reader.read([0])


def test_an_exception_does_not_leave_the_device_in_its_mode(made):
    """Such as that of Ctrl-C: the device leaves before the exception is raised again."""
    device = made()

    def interrupt(session):
        if len(session.pages) >= 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        device.reader.read(on_progress=interrupt)
    assert not device.active and device.reader.status == 'none'


@pytest.mark.slow
def test_a_thousand_sessions_leak_nothing(made):
    """Neither threads nor memory."""
    device = made()
    for _ in range(20):
        device.reader.read([0])
    gc.collect()
    tracemalloc.start()
    before, threads = tracemalloc.get_traced_memory()[0], threading.active_count()
    for number in range(1000):
        assert len(device.reader.read([number % 250])) == 1
    assert threading.active_count() <= threads
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 100_000
