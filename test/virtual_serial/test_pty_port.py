# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the device's end of a pseudo-terminal."""

import contextlib
import os
from pathlib import Path
import select
import subprocess
import sys
import threading

from bahrs_driver.errors import WriteError
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.ports import opened
from support.targets import EVERY_KIND, IMPOSSIBLE, snapshot
from support.waiting import wait_for


def test_bytes_go_both_ways_unchanged():
    """Control characters pass, too."""
    everything = bytes(range(256))
    with PtyPort() as port, opened(port.path) as far:
        port.write(everything)
        assert os.read(far, 4096) == everything
        os.write(far, everything)
        assert port.read(60.0) == everything
        assert port.read() == b''


def test_is_open():
    """The state is right before, while and after the port is open."""
    with PtyPort() as port:
        assert not port.is_open and not port.wait_until_open(0.05)
        assert port.read() == b''
        port.write(b'lost')
        assert port.write_nowait(b'lost') == 4
        with opened(port.path) as far:
            assert port.is_open and port.wait_until_open(0.0)
            with pytest.raises(BlockingIOError):
                os.read(far, 100)
        assert not port.is_open and port.read() == b''


def test_waits_until_open():
    """The reader opens the port from another thread."""
    with PtyPort() as port, contextlib.ExitStack() as stack:
        timer = threading.Timer(0.05, lambda: stack.enter_context(opened(port.path)))
        timer.start()
        assert port.wait_until_open(60.0)
        timer.join()


def take(descriptor, count):
    """Read a number of bytes in any pieces."""
    while count:
        assert select.select([descriptor], [], [], 60.0)[0]
        count -= len(os.read(descriptor, count))


def test_waits_until_read():
    """Waiting also ends when the reader closes the port."""
    with PtyPort() as port:
        assert port.wait_until_read(0.0)
        with opened(port.path) as far:
            port.write(bytes(2000))
            for count in (1000, 999):
                take(far, count)
                # What was sent is there to be read a moment later, and stays so.
                assert wait_for(lambda: not port.wait_until_read(0.0))
                assert not port.wait_until_read(0.05)
            timer = threading.Timer(0.05, take, (far, 1))
            timer.start()
            assert port.wait_until_read(60.0)
            timer.join()
            port.write(bytes(10))
        assert port.wait_until_read(0.0)


# As an ordinary user: a reader that has the port for itself alone reads half a second later.
EXCLUSIVE = """
import fcntl, os, sys, termios, threading, time
from bahrs_driver.virtual_serial.pty_port import PtyPort
if os.geteuid() == 0:
    os.setgroups([]); os.setgid(65534); os.setuid(65534)
with PtyPort() as port:
    far = os.open(port.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    fcntl.ioctl(far, termios.TIOCEXCL)
    port.write(bytes(99))
    def read():
        time.sleep(0.5)
        print(len(os.read(far, 4096)), flush=True)
    reader = threading.Thread(target=read)
    reader.start()
    print(port.wait_until_read(60.0), flush=True)
    reader.join()
    port.close()
    try:
        print(os.read(far, 1))
    except OSError:
        print('closed')
"""


def test_a_locked_port_gets_a_fixed_time():
    """An ordinary user cannot query a locked port."""
    done = subprocess.run([sys.executable, '-c', EXCLUSIVE], capture_output=True, text=True,
                          check=True)
    assert done.stdout.split()[:2] == ['99', 'True']


def test_a_write_that_must_not_block():
    """The count of written bytes is returned; the rest is lost, as on a real line."""
    with PtyPort() as port, opened(port.path) as far:
        taken = sum(port.write_nowait(bytes(1024)) for _ in range(1000))
        assert 0 < taken < 1_024_000
        got = 0
        with contextlib.suppress(BlockingIOError):
            while True:
                got += len(os.read(far, 65536))
        assert 0 < got <= taken


def test_unplugged_and_plugged_in_again_under_the_same_link(tmp_path):
    """A reader sees a hang-up; the link leads to the new port."""
    link = tmp_path / 'port'
    with PtyPort(str(link)) as port, opened(link) as far:
        assert port.name == str(link) and os.readlink(link) == port.path
        port.close()
        assert not os.path.lexists(link)
        poll = select.poll()
        poll.register(far)
        assert poll.poll(0)[0][1] & select.POLLHUP
        with PtyPort(str(link)) as again, opened(link) as far_again:
            again.write(b'back')
            assert os.read(far_again, 10) == b'back'
    assert not os.path.lexists(link)


def test_closing_twice():
    """The second call does nothing."""
    port = PtyPort()
    port.close()
    port.close()


@pytest.mark.parametrize('kind', EVERY_KIND)
def test_foreign_files_are_not_replaced(tmp_path, kind):
    """Neither a file nor a foreign link is replaced."""
    path = tmp_path / 'port'
    EVERY_KIND[kind](path)
    before = snapshot(tmp_path)
    with pytest.raises(FileExistsError, match='choose another name'):
        PtyPort(str(path))
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize('kind', sorted(set(IMPOSSIBLE) - {'trailing slash'}))
def test_a_link_that_cannot_be_created(tmp_path, kind, monkeypatch):
    """The error names the path, and no descriptor stays open."""
    monkeypatch.chdir(tmp_path)
    Path('file').touch()
    before = len(os.listdir('/proc/self/fd'))
    with pytest.raises((WriteError, FileExistsError)):
        PtyPort(IMPOSSIBLE[kind])
    assert len(os.listdir('/proc/self/fd')) == before


def test_the_link_of_a_killed_emulator_is_replaced(tmp_path):
    """The link of a running emulator is not replaced."""
    link = tmp_path / 'port'
    link.symlink_to('/dev/pts/99999')
    with PtyPort(str(link)) as port:
        assert os.readlink(link) == port.path
        with pytest.raises(FileExistsError, match='the port of another program'):
            PtyPort(str(link))
        assert os.readlink(link) == port.path


def test_a_link_that_leads_elsewhere_stays(tmp_path):
    """Another program created it later."""
    link = tmp_path / 'port'
    with PtyPort(str(link)) as first:
        link.unlink()
        link.symlink_to('/elsewhere')
        first.close()
        assert Path(os.readlink(link)) == Path('/elsewhere')
