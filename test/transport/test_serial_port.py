# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of serial devices, on pseudo-terminals."""

import contextlib
import errno
import fcntl
import os
import resource
import struct
import subprocess
import sys
import threading
import time

from bahrs_driver.errors import LinkError
from bahrs_driver.transport import link as link_module
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.serial_port import LONGEST_BACK_OFF, SerialPort
from bahrs_driver.transport.waker import Waker
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.waiting import wait_for

BAUD = 115200
TIOCGEXCL = 0x80045440
MANY_FILES = 1100               # more descriptors than select() accepts


@pytest.fixture
def port():
    """Give a port made of a pseudo-terminal."""
    with PtyPort() as made:
        yield made


@contextlib.contextmanager
def opened(path):
    """Give an open link."""
    link = Link(path, BAUD)
    link.connect()
    try:
        yield link
    finally:
        link.close()


def is_exclusive(path):
    """Return whether the port is open exclusively; only root can read it."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        return bool(struct.unpack('i', fcntl.ioctl(descriptor, TIOCGEXCL, bytes(4)))[0])
    finally:
        os.close(descriptor)


@pytest.mark.skipif(os.geteuid() != 0, reason='only root may open an exclusive port again')
def test_it_is_open_exclusively_while_it_is_open(port):
    """A pseudo-terminal would keep the mark, and lock out the driver itself."""
    with opened(port.path):
        assert is_exclusive(port.path)
    assert not is_exclusive(port.path)


# As a user without privileges: what opening the port a second time says, then opening it again.
AS_NOBODY = """
import os, sys
from bahrs_driver.transport.link import Link
os.chmod(sys.argv[1], 0o666)
if os.geteuid() == 0:
    os.setgroups([]); os.setgid(65534); os.setuid(65534)
for turn in range(3):
    link = Link(sys.argv[1], 115200)
    link.connect()
    try:
        os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        print(error.errno)
    link.close()
"""


def test_another_program_of_an_ordinary_user_cannot_open_it(port):
    """Although it ignores locks; the driver can open it repeatedly."""
    done = subprocess.run([sys.executable, '-c', AS_NOBODY, port.path],
                          capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == (f'{errno.EBUSY}\n' * 3, '')


# As a user without privileges: opening a port that a killed program had open for itself alone.
AFTER_A_KILL = """
import os, sys
from bahrs_driver.errors import LinkError
from bahrs_driver.transport.link import Link
os.chmod(sys.argv[1], 0o666)
if os.geteuid() == 0:
    os.setgroups([]); os.setgid(65534); os.setuid(65534)
if os.fork() == 0:
    link = Link(sys.argv[1], 115200)
    link.connect()
    os._exit(0)
os.wait()
try:
    Link(sys.argv[1], 115200).connect()
except LinkError as error:
    print(error)
"""


def test_a_pseudo_terminal_that_a_killed_program_had_open(port):
    """It keeps the mark until its creator ends; a serial device does not."""
    done = subprocess.run([sys.executable, '-c', AFTER_A_KILL, port.path],
                          capture_output=True, text=True, check=True)
    assert done.stdout.endswith('restart the program that made this pseudo-terminal\n')


def test_the_error_names_the_program_that_has_the_port_open(port):
    """By name and process id, including this program."""
    code = ('import sys, time; from bahrs_driver.transport.link import Link\n'
            'link = Link(sys.argv[1], 115200); link.connect(); print(flush=True); time.sleep(600)')
    with subprocess.Popen([sys.executable, '-c', code, port.path],
                          stdout=subprocess.PIPE) as other:
        try:
            other.stdout.readline()
            with pytest.raises(LinkError, match=f'in use by another program .*{other.pid}'):
                Link(port.path, BAUD).connect()
        finally:
            other.kill()
    with opened(port.path), pytest.raises(LinkError, match='which is this one'):
        Link(port.path, BAUD).connect()


def test_bytes_taken_by_another_program_are_no_loss_of_the_port(port, monkeypatch):
    """The reads are counted, and the driver pauses between them."""
    channel, waker = SerialPort(port.path, BAUD), Waker()
    port.write(b'x')
    begin = time.monotonic()
    for read in (lambda descriptor, count: b'', refuse):
        monkeypatch.setattr(os, 'read', read)
        for _ in range(50):
            assert channel.read(60.0, waker) is None
    assert channel.stolen == 100
    assert time.monotonic() - begin > 80 * LONGEST_BACK_OFF
    monkeypatch.undo()
    assert channel.read(60.0, waker).data == b'x'
    port.close()
    with pytest.raises(OSError):
        channel.read(60.0, waker)
    channel.close()


def refuse(descriptor, count):
    """Fail as a read while another program reads."""
    raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))


@pytest.fixture
def many_files():
    """Open so many files that any other descriptor is too large for select()."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard < 2 * MANY_FILES:
        pytest.skip(f'no more than {hard} files may be open here')
    resource.setrlimit(resource.RLIMIT_NOFILE, (2 * MANY_FILES, hard))
    files = [os.open('/dev/null', os.O_RDONLY) for _ in range(MANY_FILES)]
    yield
    for file in files:
        os.close(file)
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_descriptors_too_large_for_select(many_files):
    """They work for reading, writing and waking, at both ends of the cable."""
    with PtyPort() as port, opened(port.path) as link:
        assert port.fileno() > 1024
        port.write(b'abc')
        found = b''
        while len(found) < 3:
            reading = link.read()
            found += reading.data if reading else b''
        assert found == b'abc'
        link.write(b'xyz')
        assert port.read(60.0) == b'xyz'
        link.cancel()
        assert link.read() is None


def test_writing_to_a_device_that_accepts_nothing_times_out(port, monkeypatch):
    """At once if it must not wait; closing does not wait either."""
    monkeypatch.setattr(link_module, 'WRITE_TIMEOUT', 0.1)
    with opened(port.path) as link:
        with pytest.raises(LinkError, match='does not take data: it has accepted nothing'):
            while True:
                link.write(bytes(4096))
        with pytest.raises(LinkError, match='does not take data'):
            link.write(b'x', wait=False)
        monkeypatch.setattr(link_module, 'WRITE_TIMEOUT', 3600.0)
        failures = []

        def write():
            try:
                link.write(bytes(4096))
            except LinkError as error:
                failures.append(error)

        writer = threading.Thread(target=write, daemon=True)
        writer.start()
        assert wait_for(link._writing.locked)
        with pytest.raises(LinkError, match='another request waits'):
            link.write(b'x', wait=False)
        link.close()
        writer.join(60.0)
        assert not writer.is_alive() and 'does not take data' in str(failures[0])
    with pytest.raises(LinkError, match='it is not open'):
        link.write(b'x')


def test_opened_and_closed_under_a_writer_and_replugged():
    """The driver never finds its own port in use, and leaks no descriptor."""
    link = Link('/nowhere', BAUD)
    before = len(os.listdir('/proc/self/fd'))
    ended = threading.Event()

    def write():
        while not ended.is_set():
            with contextlib.suppress(LinkError):
                link.write(bytes(2000))

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for turn in range(300):
            with PtyPort() as port:
                link._path = port.path      # like a changed symbolic link
                link.connect()              # LinkError if it was in use
                port.write_nowait(b'x')
                link.read()
                if turn % 2:
                    link.close()
                    link.connect()
                if turn % 3:
                    port.close()            # pulled out while it is open
                    with pytest.raises(LinkError, match='is gone'):
                        link.read()
                link.close()
    finally:
        ended.set()
        writer.join()
    assert len(os.listdir('/proc/self/fd')) <= before


def test_descriptors_are_not_inherited(port):
    """Otherwise a child process would keep the port open."""
    with opened(port.path) as link:
        channel = link._channel
        for descriptor in (channel._descriptor, link._reader_waker.fileno()):
            assert not os.get_inheritable(descriptor)


def test_a_path_that_is_no_character_device_is_not_opened(tmp_path):
    """Merely opening a FIFO can have effects."""
    fifo = tmp_path / 'fifo'
    os.mkfifo(fifo)
    with pytest.raises(LinkError, match='is not a serial port'):
        Link(str(fifo), BAUD).connect()
    with pytest.raises(OSError) as caught:      # nobody reads it
        os.open(fifo, os.O_WRONLY | os.O_NONBLOCK)
    assert caught.value.errno == errno.ENXIO
