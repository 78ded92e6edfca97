# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Parse the name of a port: the path of a device, or a URL.

Only listed schemes and options are accepted, because others of pyserial do harm: spy://...?file=
overwrites a file, and alt:// imports any module.
"""

import math
import os
import re
from typing import NamedTuple
from urllib.parse import parse_qs, SplitResult, urlsplit
import warnings

from bahrs_driver.process.printable import printable

SCHEMES = ('socket', 'rfc2217', 'hwgrep')
TEST_SCHEME = 'loop'
EXAMPLES = {'socket': 'socket://host:4001', 'rfc2217': 'rfc2217://host:4001'}
RFC2217_OPTIONS = ('ign_set_control', 'poll_modem', 'timeout')
LONGEST_TIMEOUT = 60.0          # s, for the answer of an RFC 2217 server
MOST_BAUD = 2 ** 31 - 1
_SCHEME = re.compile('([A-Za-z][A-Za-z0-9+.-]*)://')


class Address(NamedTuple):
    """The parsed name of a port."""

    text: str
    scheme: str = ''                            # empty for a path
    host: str = ''
    port: int = 0
    pattern: re.Pattern[str] | None = None      # of hwgrep
    number: int = 1                             # of the matching devices, from 1

    @property
    def is_network(self) -> bool:
        """Whether the port is at the other end of a network connection."""
        return self.scheme in EXAMPLES


def parse_address(text: str) -> Address:
    """Parse the name of a port; ValueError if it can never be opened."""
    if not text:
        raise ValueError('it is empty: name a device such as /dev/ttyUSB0')
    if '\0' in text:
        raise ValueError('it contains a NUL character')
    match = _SCHEME.match(text)
    if match is None:
        return _path(text)
    scheme = match[1].lower()
    if scheme == 'hwgrep':
        return _search(text, text[match.end():])
    if scheme == TEST_SCHEME:
        if len(text) > match.end():
            raise ValueError(f'{TEST_SCHEME}:// takes no host and no options')
        return Address(f'{TEST_SCHEME}://', scheme)
    if scheme not in SCHEMES:
        names = ', '.join(f'{name}://' for name in SCHEMES)
        raise ValueError(f'{printable(match[0], 40)} is not supported: use the path of a device, '
                         f'or {names} ({TEST_SCHEME}:// in tests)')
    return _server(scheme + text[len(scheme):], scheme)


def check_baud_rate(baud_rate: int) -> None:
    """Raise ValueError for a baud rate that no port supports."""
    if isinstance(baud_rate, bool) or not isinstance(baud_rate, int) \
            or not 1 <= baud_rate <= MOST_BAUD:
        raise ValueError(f'the baud rate {printable(baud_rate, 40)} is not possible: it must be '
                         f'a whole number from 1 to {MOST_BAUD}')


def _path(text: str) -> Address:
    try:
        os.fsencode(text)
    except UnicodeError as error:
        raise ValueError('it contains a character that no path can have') from error
    return Address(text)


def _server(text: str, scheme: str) -> Address:
    example = EXAMPLES[scheme]
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, parts.port
        (host or '').encode('idna')
    except ValueError:                          # such as a port beyond 65535
        host, port = None, None
    # urlsplit() drops line feeds and tabs.
    if not host or not port or printable(text, len(text)) != text:
        raise ValueError(f'it must have a host and a port, such as {example}')
    if parts.username is not None or parts.path.strip('/') or parts.fragment:
        raise ValueError(f'it must be a host and a port alone, such as {example}')
    _check_options(parts, RFC2217_OPTIONS if scheme == 'rfc2217' else ())
    return Address(text, scheme, host, port)


def _check_options(parts: SplitResult, known: tuple[str, ...]) -> None:
    options = parse_qs(parts.query, keep_blank_values=True)
    for name in options:
        if name not in known:
            allowed = ' and '.join(known) or 'none'
            raise ValueError(f'option {printable(name, 40)!r} is not supported by '
                             f'{parts.scheme}://, which has {allowed}')
    for value in options.get('timeout', ()):
        if not 0 < _number(value) <= LONGEST_TIMEOUT:
            raise ValueError(f'option timeout must be a number of seconds up to '
                             f'{LONGEST_TIMEOUT:g}')


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _search(text: str, rest: str) -> Address:
    expression, *options = rest.split('&')
    number = 1
    for option in options:
        name, _, value = option.partition('=')
        if name != 'n' or not re.fullmatch('[1-9][0-9]{0,3}', value):
            raise ValueError(f'option {printable(option, 40)!r} is not supported by hwgrep://, '
                             'which has n=NUMBER only, counted from 1')
        number = int(value)
    if not expression:
        raise ValueError('it must have an expression to search for, such as hwgrep://0403:6001')
    return Address(text, 'hwgrep', pattern=_compile(expression), number=number)


def _compile(expression: str) -> re.Pattern[str]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')     # about syntax that may change its meaning
            return re.compile(expression, re.IGNORECASE)
    except (re.error, OverflowError, RecursionError, ValueError, MemoryError) as error:
        raise ValueError(f'{printable(expression, 60)} is not a regular expression: '
                         f'{printable(error)}') from error
