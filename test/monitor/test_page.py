# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the live page with a terminal and a driver."""

import contextlib
import fcntl
import os
import re
import signal
import struct
import subprocess
import termios
import threading

from bahrs_driver.virtual_serial.pty_port import PtyPort
from support.devices import Device
from support.processes import command, driver, wait_for

TIMEOUT = 60.0
CONTROL = re.compile(r'\x1b\[[0-9;?]*[A-Za-z]')


class Terminal:
    """A command on a terminal of a given size, and its output."""

    def __init__(self, size, *words):
        """Start the command."""
        self._output = b''
        self._controller, screen = os.openpty()
        fcntl.ioctl(screen, termios.TIOCSWINSZ, struct.pack('4H', *size[::-1], 0, 0))
        environment = {**os.environ, 'TERM': 'xterm-256color', 'LANG': 'C.UTF-8'}
        for name in ('COLUMNS', 'LINES', 'NO_COLOR'):
            environment.pop(name, None)
        self.child = subprocess.Popen(command(*words), stdin=screen, stdout=screen,
                                      stderr=screen, env=environment, start_new_session=True)
        os.close(screen)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with contextlib.suppress(OSError):          # the writer has ended
            while data := os.read(self._controller, 65536):
                self._output += data

    @property
    def text(self):
        """Output so far, without control sequences."""
        return CONTROL.sub('', self._output.decode(errors='replace'))

    @property
    def latest(self):
        """Latest page."""
        pages = self._output.decode(errors='replace').split('\x1b[H')
        return CONTROL.sub('', pages[-2] if len(pages) > 1 else '').replace('\r', '')

    def shows(self, words):
        """Wait until the latest page contains the words; return whether it does."""
        return wait_for(lambda: words in self.latest, TIMEOUT)

    def end(self):
        """Press Ctrl-C, and return the exit status."""
        self.child.send_signal(signal.SIGINT)
        status = self.child.wait(TIMEOUT)
        self._reader.join(TIMEOUT)
        os.close(self._controller)
        return status


@contextlib.contextmanager
def terminal(*words, size=(80, 24)):
    """Run one of our commands on a terminal, and end it at the end of the block."""
    shown = Terminal(size, *words)
    try:
        yield shown
    finally:
        if shown.child.poll() is None:
            shown.end()


def test_live_data_and_its_loss():
    """The page shows attitude, height and health, and later that data has stopped."""
    with PtyPort() as cable, terminal('bahrs', 'monitor') as page:
        assert page.shows('NO DRIVER'), page.text
        assert 'Layout' not in page.latest          # the placeholder of rich
        with driver(cable.path):
            with Device(cable):
                assert page.shows('All signals safe'), page.latest
                assert page.shows('░'), page.latest          # the ground below the horizon
                assert page.shows('magnetic heading ✓'), page.latest
                assert page.shows('roll +5.7°'), page.latest
                assert page.shows('pitch +11.5°'), page.latest
                rows = page.latest.rstrip('\n').split('\n')
                assert len(rows) <= 24 and max(map(len, rows)) <= 80
            assert page.shows('NO DATA'), page.latest
            assert page.shows('no attitude'), page.latest
        assert page.shows('DRIVER GONE'), page.latest
        assert page.end() == 0
        assert 'imu/data_raw' in page.text.rsplit('Topic', 1)[1]     # the table at the end
        assert 'Traceback' not in page.text


def test_terminal_that_is_too_small():
    """The page gives a sufficient size."""
    with terminal('bahrs', 'monitor', '--namespace', 'nobody', size=(40, 10)) as page:
        assert page.shows('80x24 is good'), page.text
        assert page.end() == 1
