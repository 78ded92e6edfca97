# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the port, on real pseudo-terminals and sockets."""

import grp
import os
import socket
import stat
import time

from bahrs_driver.errors import LinkError
from bahrs_driver.process.host_time import host_instant
from bahrs_driver.transport import link as link_module
from bahrs_driver.transport.link import Link
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.waiting import wait_for

BAUD = 115200


@pytest.fixture
def port():
    """Give a port made of a pseudo-terminal."""
    with PtyPort() as made:
        yield made


def refusal(path, baud_rate=BAUD):
    """Return the error with which the port cannot be opened."""
    with pytest.raises(LinkError) as caught:
        Link(str(path), baud_rate).connect()
    return caught.value


def sure(read):
    """Read until bytes arrive: they may take longer than a time-out."""
    results = []
    assert wait_for(lambda: results.append(read()) or results[-1])
    return results[-1]


def test_bytes_are_read_with_the_time_of_the_read(port):
    """Bytes of all values, in order."""
    link = Link(port.path, BAUD)
    link.connect()
    before = host_instant()
    port.write(bytes(range(256)))
    data = b''
    while len(data) < 256:
        reading = sure(link.read)
        after = host_instant()
        assert before.raw_ns <= reading.now.raw_ns <= after.raw_ns
        assert abs(reading.now.ros_ns - time.time_ns()) < 60 * 10 ** 9
        data += reading.data
    assert data == bytes(range(256))
    link.close()


def test_a_read_without_bytes_returns_none(port):
    """After its time-out."""
    link = Link(port.path, BAUD)
    link.connect()
    assert link.read() is None
    link.close()


def test_bytes_are_written_to_the_device(port):
    """The other end reads them."""
    link = Link(port.path, BAUD)
    link.connect()
    link.write(b'NE\x03\x00\xf0')
    assert port.read(timeout=60.0) == b'NE\x03\x00\xf0'
    link.close()


def test_missing_port(tmp_path):
    """The error names it and has a remedy."""
    error = refusal(tmp_path / 'ttyUSB9')
    assert str(error) == (f'{tmp_path}/ttyUSB9 does not exist: plug the device in, '
                          'or name another port')
    assert error.absent


def test_port_in_use(port):
    """Another program or another driver has it open."""
    first = Link(port.path, BAUD)
    first.connect()
    assert f'{port.path} is in use by another program' in str(refusal(port.path))
    first.close()
    second = Link(port.path, BAUD)
    second.connect()
    assert second.is_open
    second.close()


@pytest.mark.parametrize('make', [lambda path: path.mkdir(), lambda path: path.write_text('x')])
def test_a_path_that_is_no_serial_port(tmp_path, make):
    """Such as a directory or a file."""
    make(tmp_path / 'thing')
    assert str(refusal(tmp_path / 'thing')).startswith(f'{tmp_path}/thing is not a serial port: ')


def test_a_device_that_is_no_serial_port():
    """Such as /dev/null."""
    assert str(refusal('/dev/null')).startswith('/dev/null is not a serial port: ')


@pytest.fixture
def as_somebody():
    """Drop the capability of root to ignore file modes during a test."""
    root = os.geteuid() == 0
    if root:
        os.seteuid(65534)
    yield
    if root:
        os.seteuid(0)


def test_the_error_of_a_forbidden_port_names_the_group_to_join(port, request):
    """It is that of the port, if the group may read and write it."""
    os.chmod(port.path, stat.S_IRGRP | stat.S_IWGRP)
    if os.geteuid() == 0:
        os.chown(port.path, 0, 20)
    request.getfixturevalue('as_somebody')
    group = os.stat(port.path).st_gid
    sentence = str(refusal(port.path))
    assert f'{port.path} may not be opened by user' in sentence
    if group == 20:
        names = [entry.gr_name for entry in grp.getgrall() if entry.gr_gid == group] or ['20']
        assert f'"sudo usermod -aG {names[0]} ' in sentence


def test_forbidden_port_without_a_group_tells_of_udev(port, request):
    """If no group may use the port."""
    os.chmod(port.path, 0)
    request.getfixturevalue('as_somebody')
    sentence = str(refusal(port.path))
    assert 'its mode is c---------' in sentence and 'udev' in sentence


def test_vanished_port():
    """The next read raises LinkError, and closing does nothing."""
    port = PtyPort()
    link = Link(port.path, BAUD)
    link.connect()
    port.write(b'x')
    assert sure(link.read).data == b'x'
    port.close()
    with pytest.raises(LinkError, match='is gone') as caught:
        link.read()
    assert caught.value.absent
    link.close()
    link.close()


def test_a_waiting_read_can_be_woken(port, monkeypatch):
    """Long before its time-out, so that the node ends soon."""
    monkeypatch.setattr(link_module, 'READ_TIMEOUT', 120)
    link = Link(port.path, BAUD)
    link.connect()
    link.cancel()
    begin = time.monotonic()
    assert link.read() is None
    assert time.monotonic() - begin < 60
    link.close()


@pytest.fixture
def server():
    """Give a listening socket on a free port."""
    with socket.create_server(('127.0.0.1', 0)) as made:
        made.settimeout(60)
        yield made


def test_socket_url(server):
    """All bytes arrive, in few reads, and the end is detected."""
    link = Link(f'socket://127.0.0.1:{server.getsockname()[1]}', BAUD)
    link.connect()
    peer, _ = server.accept()
    peer.sendall(bytes(3000))
    data, reads = b'', 0
    while len(data) < 3000:
        data += sure(link.read).data
        reads += 1
    assert data == bytes(3000) and reads < 20
    peer.close()
    with pytest.raises(LinkError, match='is gone'):
        sure(link.read)
    link.close()


def test_the_last_byte_before_a_socket_is_closed(server):
    """It is read, and the next read raises LinkError."""
    link = Link(f'socket://127.0.0.1:{server.getsockname()[1]}', BAUD)
    link.connect()
    peer, _ = server.accept()
    peer.sendall(b'x')
    peer.close()
    assert sure(link.read).data == b'x'
    with pytest.raises(LinkError, match='is gone'):
        sure(link.read)
    link.close()


def test_socket_without_server():
    """The error has the reason and no errno."""
    with socket.socket() as deaf:           # reserves the number of the port
        deaf.bind(('127.0.0.1', 0))
        number = deaf.getsockname()[1]
        assert str(refusal(f'socket://127.0.0.1:{number}')) == (
            f'socket://127.0.0.1:{number} cannot be opened: Connection refused; is the serial '
            'server running, and is this its TCP port?')


def test_an_unknown_url_is_a_mistake_of_the_caller():
    """Trying again cannot help."""
    with pytest.raises(ValueError, match='foo:// is not supported'):
        Link('foo://bar', BAUD)


@pytest.mark.parametrize('url', ['socket://', 'socket://host', 'socket://:4001'])
def test_a_socket_without_host_or_port_is_a_mistake_of_the_caller(url):
    """The error has an example."""
    with pytest.raises(ValueError, match='must have a host and a port, such as socket://'):
        Link(url, BAUD)


def test_a_url_that_searches_for_a_device_may_find_it_later():
    """A device that is not found is a LinkError."""
    link = Link('hwgrep://no-such-device-anywhere', BAUD)
    with pytest.raises(LinkError, match='hwgrep://no-such-device-anywhere cannot be opened'):
        link.connect()
    assert not link.is_open
    link.close()


@pytest.mark.parametrize('name, expected', [
    ('/dev/ttyUSB0', 86805), ('/dev/ttyACM0', 0), ('socket://host:4001', 0)])
def test_time_of_a_byte_on_the_line(name, expected):
    """Native USB and networks have no line rate."""
    assert Link(name, BAUD).byte_time_ns == expected
