# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of ports at the other end of a network connection, on this machine."""

import contextlib
from pathlib import Path
import shutil
import socket
import subprocess
import sys
import threading
import time

from bahrs_driver.errors import LinkError
from bahrs_driver.transport import link as link_module
from bahrs_driver.transport import pyserial_url, tcp
from bahrs_driver.transport.link import Link
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from serial import rfc2217
from support.serial_servers import SERVERS
from support.waiting import wait_for

BAUD = 115200
KINDS = ('socket', 'rfc2217')


@contextlib.contextmanager
def listening():
    """Give a listening socket and the number of its port."""
    with socket.create_server(('127.0.0.1', 0)) as made:
        made.settimeout(60)
        yield made, made.getsockname()[1]


@pytest.fixture
def served():
    """Give a function that returns an open link of some kind, and its server."""
    with contextlib.ExitStack() as stack:
        def connect(kind):
            made, number = stack.enter_context(listening())
            servers = []
            thread = threading.Thread(
                target=lambda: servers.append(SERVERS[kind](made.accept()[0])))
            thread.start()
            link = Link(f'{kind}://127.0.0.1:{number}', BAUD)
            stack.callback(link.close)
            link.connect()
            thread.join()
            stack.callback(servers[0].close)
            return link, servers[0]
        yield connect


def socket_of(link):
    """Return the socket of a link."""
    channel = link._channel
    return channel._socket if link.port.startswith('socket') else channel._port._socket


def collected(link, size):
    """Read a count of bytes."""
    data = b''
    while len(data) < size:
        reading = link.read()
        data += reading.data if reading else b''
    return data


@pytest.mark.parametrize('kind', KINDS)
def test_bytes_of_all_values_are_read_and_written(served, kind):
    """None of them is interpreted as a command of the protocol."""
    link, server = served(kind)
    server.send(bytes(range(256)) * 4)
    assert collected(link, 1024) == bytes(range(256)) * 4
    assert link.byte_time_ns == 0 and link.is_network


def test_written_bytes_reach_the_device(served):
    """Through the escapes of the protocol."""
    link, _ = served('rfc2217')
    link.write(bytes(range(256)))
    assert collected(link, 256) == bytes(range(256))


@pytest.mark.parametrize('kind', KINDS)
def test_the_kernel_monitors_the_connection(served, kind):
    """It closes it after a few seconds without an answer."""
    link, _ = served(kind)
    for level, option, value in tcp.OPTIONS:
        assert bool(socket_of(link).getsockopt(level, option)) == bool(value)
        if option != socket.SO_KEEPALIVE:
            assert socket_of(link).getsockopt(level, option) == value
    assert tcp.DEAD_AFTER <= 10


@pytest.mark.parametrize('kind', KINDS)
def test_an_orderly_close_is_detected_at_once(served, kind):
    """The error mentions the connection."""
    link, server = served(kind)
    server.close()
    with pytest.raises(LinkError, match='is gone: the (other end|connection).* closed') as caught:
        while True:
            link.read()
    assert caught.value.absent and 'the driver goes on trying' in str(caught.value)


def test_no_bytes_of_a_server_print_a_traceback(served, capfd):
    """An end without a beginning makes the thread of pyserial raise."""
    link, server = served('rfc2217')
    server.write(rfc2217.IAC + rfc2217.SE)
    with pytest.raises(LinkError, match='is gone'):
        while True:
            link.read()
    link.close()
    assert capfd.readouterr().err == ''


# Bytes of which many are commands of Telnet.
TELNET = st.lists(st.sampled_from([rfc2217.IAC, rfc2217.SB, rfc2217.SE, rfc2217.WILL, rfc2217.DO,
                                   rfc2217.DONT, rfc2217.COM_PORT_OPTION, b'\x00', b'\x65',
                                   b'\x6b', b'A']), max_size=60).map(b''.join)


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(TELNET)
def test_any_bytes_of_a_server_are_handled(served, capfd, data):
    """The port returns data, or is gone, without a traceback or an endless wait."""
    link, server = served('rfc2217')
    server.write(data)
    server.close()
    with pytest.raises(LinkError):
        while True:
            link.read()
    link.close()
    assert capfd.readouterr().err == ''


def test_a_server_that_floods_is_slowed_down(served, monkeypatch):
    """The queue is bounded, and the port can be closed."""
    monkeypatch.setattr(pyserial_url, 'LONGEST_QUEUE', 5000)
    link, server = served('rfc2217')
    flood = threading.Thread(target=server.write, args=(bytes(3_000_000),), daemon=True)
    flood.start()
    waiting = link._channel._port._read_buffer
    assert wait_for(lambda: waiting.qsize() == 5000)
    begin = time.monotonic()
    link.close()
    assert time.monotonic() - begin < 5.0


@pytest.mark.parametrize('kind', KINDS)
def test_a_server_that_accepts_and_sends_nothing(kind):
    """Raw: a silent device. RFC 2217: an error, because the server does not negotiate."""
    with listening() as (_, number):
        link = Link(f'{kind}://127.0.0.1:{number}', BAUD)
        if kind == 'socket':
            link.connect()
            assert link.read() is None
            link.close()
        else:
            with pytest.raises(LinkError, match='the server does not accept RFC 2217') as caught:
                link.connect()
            assert '[' not in str(caught.value)


@pytest.mark.parametrize('kind', KINDS)
def test_connecting_can_be_cancelled(kind, monkeypatch):
    """Even during the lookup of a name, which nothing can interrupt."""
    looked_up, ended = threading.Event(), threading.Event()

    def look_up(*_, **__):
        looked_up.set()
        ended.wait(60)
        raise socket.gaierror(-3, 'Temporary failure in name resolution')

    monkeypatch.setattr(socket, 'getaddrinfo', look_up)
    link, errors = Link(f'{kind}://nowhere.invalid:4001', BAUD), []

    def connect():
        try:
            link.connect()
        except LinkError as error:
            errors.append(error)

    thread = threading.Thread(target=connect)
    thread.start()
    assert looked_up.wait(60)
    link.cancel()
    thread.join(30)
    assert not thread.is_alive() and errors
    ended.set()


def test_a_connection_after_cancellation_is_closed(monkeypatch):
    """It was established after the wait had been cancelled."""
    made, go = [], threading.Event()

    class Late:
        def __init__(self, *_):
            go.wait(60)
            made.append(self)
            self.closed = threading.Event()

        def close(self):
            self.closed.set()

    monkeypatch.setattr(link_module, 'TcpConnection', Late)
    link = Link('socket://127.0.0.1:1', BAUD)
    link.cancel()
    with pytest.raises(LinkError, match='the driver is being stopped'):
        link.connect()
    go.set()
    assert wait_for(lambda: made) and made[0].closed.wait(60)


def test_all_addresses_of_a_host_share_one_time_limit(monkeypatch):
    """Many addresses that do not answer would take minutes."""
    timeouts = []

    class Deaf(socket.socket):
        def settimeout(self, timeout):
            timeouts.append(timeout)

        def connect(self, address):
            time.sleep(0.02)
            raise TimeoutError('timed out')

    monkeypatch.setattr(socket, 'getaddrinfo', lambda *_, **__: [
        (socket.AF_INET, socket.SOCK_STREAM, 0, '', ('192.0.2.1', 1))] * 3)
    monkeypatch.setattr(socket, 'socket', Deaf)
    with pytest.raises(LinkError, match='its host has not answered for 5 s; check its power'):
        Link('socket://many:1', BAUD).connect()
    assert timeouts[0] <= tcp.CONNECT_TIMEOUT and sorted(timeouts, reverse=True) == timeouts
    assert timeouts[0] > timeouts[-1]


# Run in a network of its own: what a link says of a peer that vanishes without a word. The
# network is switched off, so nothing that is sent arrives, and nothing comes back.
VANISHING = """
import socket, subprocess, sys, threading, time
from bahrs_driver.errors import LinkError
from bahrs_driver.transport.link import Link
sys.path.insert(0, sys.argv[2])
from support.serial_servers import SERVERS

subprocess.run(['ip', 'link', 'set', 'lo', 'up'], check=True)
kind, writes = sys.argv[1], sys.argv[3] == 'writes'
server = socket.create_server(('127.0.0.1', 0))
link = Link(f'{kind}://127.0.0.1:{server.getsockname()[1]}', 115200)
served = []
threading.Thread(target=lambda: served.append(
    SERVERS[kind](server.accept()[0])), daemon=True).start()
link.connect()
served[0].send(b'x') if served else None
link.read()
subprocess.run(['ip', 'link', 'set', 'lo', 'down'], check=True)
begin = time.monotonic()
try:
    while time.monotonic() - begin < 60:
        if writes and time.monotonic() - begin < 0.5:
            link.write(b'request')
        link.read()
    print(60, 'nothing noticed')
except LinkError as error:
    print(time.monotonic() - begin, error)
"""


def unshare():
    """Return the command that runs a process in its own network namespace; None if not allowed."""
    for words in (['unshare', '-n'], ['unshare', '-rn']):
        if shutil.which('unshare') and shutil.which('ip') and subprocess.run(
                [*words, 'ip', 'link', 'set', 'lo', 'up'], capture_output=True).returncode == 0:
            return words
    return None


@pytest.mark.parametrize('writes', ['writes', 'listens'])
@pytest.mark.parametrize('kind', KINDS)
def test_a_peer_that_vanishes_is_detected(kind, writes):
    """Such as a serial server that loses power, within seconds."""
    words = unshare()
    if words is None:
        pytest.skip('a network of its own needs privileges, and unshare and ip')
    folder = str(Path(__file__).parents[1])
    done = subprocess.run([*words, sys.executable, '-c', VANISHING, kind, folder, writes],
                          capture_output=True, text=True, timeout=300, check=True)
    elapsed, _, sentence = done.stdout.strip().partition(' ')
    assert 'is gone: ' in sentence and 'connection' in sentence, done.stdout
    assert 'the driver goes on trying' in sentence
    assert float(elapsed) < 30, done.stdout
