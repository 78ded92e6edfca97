# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of parsing a port; opening any text fails with one sentence."""

import os

from bahrs_driver.errors import LinkError
from bahrs_driver.transport import address as address_module
from bahrs_driver.transport.address import parse_address, SCHEMES, TEST_SCHEME
from bahrs_driver.transport.link import Link
from bahrs_driver.virtual_serial.pty_port import PtyPort
from hypothesis import example, given, strategies as st
import pytest

BAUD = 115200


@pytest.mark.parametrize('text, scheme, host, port', [
    ('/dev/ttyUSB0', '', '', 0),
    ('relative/path', '', '', 0),
    ('/dev/odd://name', '', '', 0),
    ('socket://host:4001', 'socket', 'host', 4001),
    ('SOCKET://Host:4001/', 'socket', 'host', 4001),
    ('socket://[::1]:4001', 'socket', '::1', 4001),
    ('rfc2217://10.0.0.1:4001?timeout=3&ign_set_control', 'rfc2217', '10.0.0.1', 4001),
    ('loop://', 'loop', '', 0),
])
def test_paths_and_supported_urls(text, scheme, host, port):
    """They are parsed into scheme, host and port."""
    address = parse_address(text)
    assert (address.scheme, address.host, address.port) == (scheme, host, port)


def test_a_search_for_a_device():
    """By a regular expression, and a number among the devices that match."""
    address = parse_address('hwgrep://0403:6001&n=2')
    assert address.pattern.search('USB VID:PID=0403:6001') and address.number == 2
    assert parse_address('hwgrep://FTDI').number == 1


@pytest.mark.parametrize('text, words', [
    ('', 'it is empty'),
    ('/dev/tty\0USB0', 'a NUL character'),
    ('/dev/\ud800', 'a character that no path can have'),
    ('foo://bar', 'foo:// is not supported: use the path of a device, or socket://, rfc2217://, '
                  'hwgrep:// (loop:// in tests)'),
    ('spy:///dev/ttyUSB0?file=/tmp/x', 'spy:// is not supported'),
    ('alt:///dev/ttyUSB0?class=VTIMESerial', 'alt:// is not supported'),
    ('cp2110://0001', 'cp2110:// is not supported'),
    ('socket://', 'must have a host and a port, such as socket://host:4001'),
    ('socket://:4001', 'must have a host and a port'),
    ('socket://host:99999', 'must have a host and a port'),
    ('socket://host:four', 'must have a host and a port'),
    ('socket://[::1', 'must have a host and a port'),
    ('socket://ho\nst:4001', 'must have a host and a port'),
    ('socket://host:4001/path', 'a host and a port alone'),
    ('socket://user@host:4001', 'a host and a port alone'),
    ('socket://host:4001?logging=debug', "option 'logging' is not supported by socket://"),
    ('rfc2217://host:4001?logging=debug', 'which has ign_set_control and poll_modem and timeout'),
    ('rfc2217://host:4001?timeout=1e9', 'option timeout must be a number of seconds up to 60'),
    ('rfc2217://host:4001?timeout=soon', 'option timeout must be'),
    ('hwgrep://', 'must have an expression'),
    ('hwgrep://(', '( is not a regular expression: missing )'),
    ('hwgrep://a{99999999999}', 'is not a regular expression'),
    ('hwgrep://FTDI&skip_busy', "'skip_busy' is not supported by hwgrep://, which has n=NUMBER"),
    ('hwgrep://FTDI&n=0', "'n=0' is not supported"),
    ('loop://?logging=debug', 'takes no host and no options'),
])
def test_ports_that_can_never_be_opened(text, words):
    """The error says what is valid."""
    with pytest.raises(ValueError) as caught:
        Link(text, BAUD)
    assert words in str(caught.value) and '\n' not in str(caught.value)


@pytest.mark.parametrize('baud_rate', [0, -1, 2 ** 31, 2 ** 70, 9600.0, True, '9600', None])
def test_baud_rates_that_no_port_has(baud_rate):
    """They are a mistake of the caller."""
    with pytest.raises(ValueError, match='baud rate .* is not possible'):
        Link('/dev/ttyUSB0', baud_rate)


def test_no_other_url_touches_a_file(tmp_path):
    """The spy:// of pyserial would overwrite it when the link is created."""
    file = tmp_path / 'precious'
    file.write_text('data')
    for url in (f'spy:///dev/null?file={file}', f'spy://loop://?file={file}',
                f'SPY:///dev/null?file={file}', f'alt:///dev/null?class=spy&file={file}',
                f'hwgrep://.&file={file}', f'loop://?file={file}', f'socket://a:1?file={file}'):
        with pytest.raises(ValueError):
            Link(url, BAUD)
    assert file.read_text() == 'data'


def test_all_schemes_of_pyserial_are_considered():
    """Those that are not accepted are not for ports, or do harm."""
    import serial.urlhandler
    folder = os.path.dirname(serial.urlhandler.__file__)
    found = {name[9:-3] for name in os.listdir(folder) if name.startswith('protocol_')}
    assert found - {*SCHEMES, TEST_SCHEME} <= {'alt', 'cp2110', 'spy'}


TEXTS = st.one_of(
    st.text(max_size=60),
    st.text(st.characters(), max_size=20).map(lambda text: f'/dev/{text}'),
    st.builds('{}://{}'.format, st.sampled_from([
        *SCHEMES, TEST_SCHEME, 'spy', 'alt', 'SPY', 'x.y', 'os', '']), st.text(max_size=30)),
    st.builds('socket://127.0.0.1:{}{}'.format, st.integers(-5, 70000), st.text(max_size=9)),
    st.builds('hwgrep://{}'.format, st.text('()[]{}|*+?^$.\\a1&=,', max_size=12)),
    st.integers(200, 9000).map(lambda length: '/dev/' + 'x' * length))
BAUDS = st.one_of(st.integers(-10, 10 ** 12), st.integers(), st.sampled_from([
    50, 9600, 115200, 921600, 12345, 3_000_000, 2 ** 31 - 1]))


@given(TEXTS, BAUDS)
@example('hwgrep://(', BAUD)
@example('/dev/tty\udcff', BAUD)
@example('/dev/' + 'x' * 5000, BAUD)
@example('/dev/null', 2 ** 31 - 1)
@example('\x1b[2J\n/dev/x', BAUD)
@example('/proc/self/mem', BAUD)
@example('.', BAUD)
@example('~', BAUD)
def test_any_text_and_any_baud_rate(text, baud_rate):
    """The caller is wrong, or the port cannot be opened; both in one printable sentence."""
    with pytest.MonkeyPatch.context() as patch:
        # No name is looked up, and no connection is made.
        patch.setattr('socket.getaddrinfo', unknown_host)
        try:
            link = Link(text, baud_rate)
        except ValueError as error:
            assert not isinstance(error, UnicodeError)
            sentence = str(error)
        else:
            sentence = opening(link)
        assert sentence.isprintable() or not sentence


def unknown_host(*_, **__):
    """Fail as a failed lookup."""
    import socket
    raise socket.gaierror(-2, 'Name or service not known')


def opening(link):
    """Return why a link cannot be opened; empty if it can."""
    try:
        link.connect()
    except LinkError as error:
        return str(error)
    finally:
        link.close()
    return ''


@given(st.integers(1, address_module.MOST_BAUD))
@example(2 ** 31 - 1)
@example(1)
def test_any_baud_rate_on_an_existing_port(baud_rate):
    """It is set, or the error names it."""
    with PtyPort() as port:
        sentence = opening(Link(port.path, baud_rate))
        assert not sentence or f'does not support {baud_rate} baud' in sentence
