# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of explanations, which never raise, for any error and any state of the system."""

import errno
import os
import socket
import stat
import subprocess
import sys
import termios

from bahrs_driver.errors import DeviceNotFound, LinkError
from bahrs_driver.transport import explain
from bahrs_driver.transport.explain import Target, why_gone, why_not_open, why_not_written
from bahrs_driver.transport.tcp import ConnectionClosed
from hypothesis import given, strategies as st
import pytest
import serial

CODES = sorted(errno.errorcode)


class Unspeakable(Exception):
    """An exception that cannot be described."""

    def __str__(self):
        """Fail."""
        raise RuntimeError


def wrapped(code):
    """Return an error as pyserial raises it, without an errno."""
    try:
        try:
            raise termios.error(code, os.strerror(code))
        except termios.error as error:
            raise serial.SerialException(f'Could not configure port: {error}')
    except serial.SerialException as error:
        return error


ERRORS = st.one_of(
    st.sampled_from(CODES).map(lambda code: OSError(code, os.strerror(code))),
    st.sampled_from(CODES).map(lambda code: serial.SerialException(
        code, f'could not open port: [Errno {code}] {os.strerror(code)}')),
    st.sampled_from(CODES).map(wrapped),
    st.integers().map(lambda code: OSError(code, 'odd')),
    st.text().map(OSError), st.text().map(ValueError), st.text().map(termios.error),
    st.sampled_from([
        Unspeakable(), OverflowError(), KeyError(None), MemoryError(), DeviceNotFound(),
        ConnectionClosed(104, 'x'), socket.gaierror(-2, 'Name or service not known'),
        TimeoutError(), UnicodeEncodeError('utf-8', 'x', 0, 1, 'bad'), EOFError(),
        NotImplementedError('write_timeout'), OSError(), OSError('[Errno 5] ] '),
        serial.SerialException('Remote does not seem to support RFC2217')]))
PATHS = st.sampled_from(['', '/dev/null', '/dev/none', '/', '/etc/passwd', 'relative',
                         '/root/x/y', '/proc/self/fd/0', '/dev/' + 'x' * 5000, '/dev/ptmx',
                         '/dev/\udcff'])


@given(PATHS, ERRORS, st.booleans())
def test_any_error_on_any_path(path, error, was_open):
    """It is a LinkError with one printable sentence that names the port."""
    target = Target(explain.printable(path) or 'socket://host:1', path, 115200, was_open)
    for function in (why_not_open, why_gone, why_not_written):
        found = function(target, error)
        assert isinstance(found, LinkError)
        assert str(found).isprintable() and str(found).startswith(target.name)


@pytest.mark.parametrize('broken', ['os.stat', 'os.access', 'os.geteuid', 'os.path.realpath',
                                    'pwd.getpwuid', 'grp.getgrgid', 'os.listdir', 'os.major'])
def test_an_explanation_survives_failures_of_the_system(monkeypatch, broken):
    """Such as os.stat in a directory without access."""
    def fail(*_, **__):
        raise PermissionError(errno.EACCES, 'Permission denied')

    monkeypatch.setattr(broken, fail)
    for code in CODES:
        error = why_not_open(Target('/dev/x', '/dev/x', 115200, False), OSError(code, 'x'))
        assert str(error).startswith('/dev/x ')


@pytest.mark.parametrize('code, words', [
    (errno.ENOENT, 'does not exist: plug the device in, or name another port'),
    (errno.ENXIO, 'does not exist'), (errno.ENODEV, 'does not exist'),
    (errno.EBUSY, 'is in use by another program'),
    (errno.EMFILE, 'too many files are open'),
    (errno.EIO, 'has no working hardware'),
    (errno.ENOTTY, 'is not a serial port'),
    (errno.ENAMETOOLONG, 'is not a serial port'),
])
def test_common_errors_have_a_remedy(code, words):
    """For each errno that users meet."""
    error = why_not_open(Target('/dev/x', '/dev/x', 9600, False), OSError(code, 'x'))
    assert words in str(error)


@pytest.mark.parametrize('error, words', [
    (ConnectionRefusedError(errno.ECONNREFUSED, 'Connection refused'), 'is the serial server'),
    (socket.gaierror(-2, 'Name or service not known'), 'no such host is known'),
    (TimeoutError('timed out'), 'has not answered for 5 s'),
    (OSError(errno.EHOSTUNREACH, 'No route to host'), 'cannot be reached'),
    (serial.SerialException('Remote does not seem to support RFC2217 or BINARY mode [we-B]'),
     'does not accept RFC 2217'),
])
def test_common_errors_of_servers_have_a_remedy(error, words):
    """And no file is searched for the port of a server."""
    found = why_not_open(Target('socket://h:1', '', 9600, False), error)
    assert words in str(found) and found.absent


# Run as nobody: the sentence for a port in a directory that nobody may enter.
AS_NOBODY = """
import os, sys
from bahrs_driver.errors import LinkError
from bahrs_driver.transport.link import Link
os.setgroups([]); os.setgid(65534); os.setuid(65534)
try:
    Link(sys.argv[1], 115200).connect()
except LinkError as error:
    print(error)
"""


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can become another user')
def test_a_directory_without_access(tmp_path):
    """The error names the directory."""
    folder = tmp_path / 'closed'
    folder.mkdir(mode=0o700)
    for parent in tmp_path.parents[:-2]:
        parent.chmod(parent.stat().st_mode | stat.S_IXOTH)
    tmp_path.chmod(0o755)
    done = subprocess.run([sys.executable, '-c', AS_NOBODY, str(folder / 'ttyUSB0')],
                          capture_output=True, text=True, check=True)
    assert done.stdout.strip() == (
        f'{folder}/ttyUSB0 may not be opened by user nobody: they may not enter {folder}, whose '
        f'mode is drwx------; find the folder to open: "namei -l {folder}/ttyUSB0"')
