# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs replay`, as a process."""

import os
import signal
import time

from bahrs_driver.link import Link
from bahrs_driver.protocol.bahrs import Inertial, Navigation
from bahrs_driver.protocol.bahrs_frames import BahrsCodec
from bahrs_driver.protocol.integrity import Integrity
from processes import running, wait_for
import pytest

SAFE = (Integrity.SAFE,) * 6


def stream(seconds):
    """Return inertial frames at 200 Hz and navigation frames at 100 Hz, with noise between."""
    codec, data = BahrsCodec(), b''
    for index in range(200 * seconds):
        data += codec.encode(Inertial(index % 256, (0.0,) * 3, (0.0,) * 3, SAFE), 2)
        if index % 2 == 0:
            data += codec.encode(
                Navigation(index // 2 % 256, 0.0, 0.0, 0.0, 0.0, 0.0, SAFE[:5]), 2)
        if index % 7 == 0:
            data += b'noise NE'
    return data


@pytest.mark.parametrize('rate', [1, 4])
def test_every_byte_comes_at_the_rate_of_the_device(tmp_path, rate):
    """Two seconds of it, or four times faster; noise included."""
    data, file, link = stream(2), tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(data)
    with running('bahrs', 'replay', str(file), '--link', str(link), '--rate', str(rate)) as player:
        assert wait_for(lambda: player.lines)
        assert player.lines[0].strip() == str(link)
        port = Link(str(link), 115200)
        begin = time.monotonic()
        port.connect()
        got = b''
        while len(got) < len(data):
            reading = port.read()
            if reading:
                got += reading.data
        took = time.monotonic() - begin
        port.close()
        assert player.wait() == 0
    assert got == data
    assert took >= 2 / rate - 0.01
    assert not os.path.lexists(link)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_interrupted(tmp_path, number):
    """Ctrl-C ends it, or a signal from elsewhere, and its link goes."""
    file, link = tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(stream(1))
    with running('bahrs', 'replay', str(file), '--link', str(link)) as player:
        assert wait_for(lambda: player.lines)
        assert player.end(number) == 130
        assert 'Traceback' not in player.text
    assert not os.path.lexists(link)


def test_a_link_that_would_hide_a_file(tmp_path):
    """It is refused, and the file stays."""
    file = tmp_path / 'data.bin'
    file.write_bytes(b'x')
    with running('bahrs', 'replay', str(file), '--link', str(file)) as player:
        assert player.wait() == 1
        assert 'exists and is not a symbolic link' in player.text
    assert file.read_bytes() == b'x'


@pytest.mark.parametrize('rate', ['0', '-1', 'fast'])
def test_bad_rate(rate):
    """It must be more than 0."""
    with running('bahrs', 'replay', 'x', '--rate', rate) as player:
        assert player.wait() == 2
        assert '--rate' in player.text and 'Traceback' not in player.text
