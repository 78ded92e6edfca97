# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of sessions on a link that somebody else reads."""

import contextlib
import gc
import queue
import threading
import time
import tracemalloc

from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceHabits
from bahrs_driver.errors import NvmError
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.transport import nvm_reader
from bahrs_driver.transport.link import LinkError
from bahrs_driver.transport.nvm_reader import NvmReader, SessionOptions
import pytest
from support.processes import wait_for

IMAGE = bytes(index * 13 % 256 for index in range(8000))
LONG = 60.0             # s, for what should be at once
PATIENT = SessionOptions(enter_timeout=LONG)


class Device:
    """A link with a device at its end; who reads the link hands over its answers, in order."""

    def __init__(self, **habits):
        """Answer at once, unless told to be silent."""
        self._mode = DiagnosticsMode(ServiceHabits(image=IMAGE, timeout=LONG, **habits))
        self._codec = BahrsCodec()
        self._answers = queue.Queue()
        self._receiver = threading.Thread(target=self._receive)
        self.reader = NvmReader(self, lambda: 3)
        self.silent = False
        self.broken = False

    def _receive(self):
        for answer in iter(self._answers.get, None):
            self.reader.receive(*answer)

    def __enter__(self):
        """Begin to read the link."""
        self._receiver.start()
        return self

    def __exit__(self, *_):
        """Read no more."""
        self._answers.put(None)
        self._receiver.join()

    def write(self, data):
        """Take what the host sends."""
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
        yield lambda **habits: stack.enter_context(Device(**habits))


@pytest.fixture
def in_background():
    """Give a function that reads all pages in another thread, and waits for it at the end."""
    threads = []

    def start(device):
        result = {}

        def work():
            try:
                result['pages'] = device.reader.read(options=PATIENT)
            except NvmError as error:
                result['error'] = str(error)
        threads.append(threading.Thread(target=work))
        threads[-1].start()
        assert wait_for(lambda: device.reader.busy)
        return result, threads[-1]

    yield start
    for thread in threads:
        thread.join()


def test_pages(made):
    """By number."""
    device = made()
    assert device.reader.read([3, 249]) == {3: IMAGE[96:128], 249: IMAGE[-32:]}
    assert not device.active and not device.reader.busy


def test_each_page_is_handed_over_as_it_is_read(made):
    """In order, and those before a failure, too."""
    device, pages, progress = made(error_pages=frozenset({3})), [], []
    with pytest.raises(NvmError, match='cannot read page 3'):
        device.reader.read(range(5), on_page=lambda *page: pages.append(page),
                           on_progress=lambda session: progress.append(len(pages)))
    assert pages == [(number, IMAGE[32 * number:32 * number + 32]) for number in range(3)]
    assert {1, 2} & set(progress), 'the first were handed over when all had been read'


def test_a_page_that_cannot_be_handed_over_ends_the_session(made):
    """The device is made to leave, and the reason goes on to who asked."""
    device = made()

    def fail(*_):
        raise ValueError('no longer')

    with pytest.raises(ValueError, match='no longer'):
        device.reader.read([0, 1], on_page=fail)
    assert not device.active and not device.reader.busy


def test_the_receiver_is_never_held_up(made, in_background):
    """Neither by a link that takes its time nor by what is done with pages."""
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
    """Whoever waits is told; nobody may begin after it."""
    device = made()
    result, thread = in_background(device)
    assert wait_for(lambda: device.active)
    device.reader.end('the driver is ending', LONG)
    assert not device.active and not device.reader.busy
    thread.join()
    assert result == {'error': 'the driver is ending'}
    with pytest.raises(NvmError, match='the driver is ending'):
        device.reader.read([0])


def test_the_end_does_not_wait_for_a_device_that_says_nothing(made, in_background):
    """Nor for a link that takes nothing."""
    for link in ('silent', 'broken'):
        device = made()
        setattr(device, link, True)
        result, thread = in_background(device)
        begin = time.monotonic()
        device.reader.end('the driver is ending')
        thread.join()
        assert time.monotonic() - begin < nvm_reader.LOSS_TIME
        assert result == {'error': 'the driver is ending'}


def test_failure_has_its_reason(made):
    """And leaves the reader as it was."""
    device = made(error_pages=frozenset({1}))
    with pytest.raises(NvmError, match='cannot read page 1'):
        device.reader.read([1])
    assert device.reader.read([2]) == {2: IMAGE[64:96]}


def test_only_one_at_a_time(made, in_background):
    """The second is refused at once; the first goes on until it is cancelled."""
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
    """Whoever waits is told at once."""
    device = made()
    device.silent = True
    result, thread = in_background(device)
    device.reader.lost('/dev/ttyUSB0 is gone')
    thread.join()
    assert result == {'error': '/dev/ttyUSB0 is gone'}


def test_a_write_that_fails_before_its_link_is_known_to_be_lost(made, in_background, monkeypatch):
    """The reason is that of the reader of the link, who knows what to do."""
    monkeypatch.setattr(nvm_reader, 'LOSS_TIME', LONG)
    device = made()
    device.broken = True
    result, thread = in_background(device)
    device.reader.lost('/dev/ttyUSB0 is gone: plug it in again')
    thread.join()
    assert result == {'error': '/dev/ttyUSB0 is gone: plug it in again'}


def test_link_that_takes_no_data(made, monkeypatch):
    """The reason is that of the link."""
    monkeypatch.setattr(nvm_reader, 'LOSS_TIME', 0.01)
    device = made()
    device.broken = True
    with pytest.raises(NvmError, match='the port is gone'):
        device.reader.read([0])


def test_an_exception_does_not_leave_the_device_in_its_mode(made):
    """Ctrl-C is one: the device is told to leave before it goes on."""
    device = made()

    def interrupt(session):
        if len(session.pages) == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        device.reader.read(on_progress=interrupt)
    assert not device.active and not device.reader.busy


def test_a_thousand_sessions_leak_nothing(made):
    """No thread, and no memory to speak of."""
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
