# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`make run`: an emulated device, the driver, and a live view of its topics, ended together."""

import argparse
from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
from threading import Event
from typing import TextIO

from bahrs_driver.devices.registry import DEFAULT, DEVICES

BIN = Path(sys.executable).parent
END_TIMEOUT = 5.0       # s
NO_DATA = 1             # exit status of the monitor


def main() -> int:
    """Run until the time is up, Ctrl-C, or the driver ends; 1 if no data came."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--port', help='use this port instead of an emulated device')
    parser.add_argument('--sensor', default=DEFAULT, choices=tuple(DEVICES),
                        help='which device (default: %(default)s)')
    parser.add_argument('--duration', type=float, help='end after so many seconds')
    options = parser.parse_args()
    # Ctrl-C reaches the live view, too, which ends by itself; the others are in groups of
    # their own, and are ended when it has.
    interrupted = Event()
    signal.signal(signal.SIGINT, lambda *_: interrupted.set())
    # Nobody else would end them then.
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        logs = {name: stack.enter_context(open(f'{folder}/{name}.log', 'w+'))
                for name in ('emulator', 'driver', 'monitor')}
        port = options.port
        if port is None:
            port = f'{folder}/bahrs'
            emulator = stack.enter_context(
                process('bahrs', 'emulate', '--sensor', options.sensor, '--link', port, '--wait',
                        stdin=subprocess.DEVNULL, stderr=logs['emulator'],
                        start_new_session=True))
            if not emulator.stdout.readline():      # it prints the port when there is one
                emulator.wait()
                return told(emulator, logs['emulator'])
        driver = stack.enter_context(
            process('driver_node', '--ros-args', '-p', f'port:={port}',
                    '-p', f'sensor:={options.sensor}', stderr=logs['driver'],
                    start_new_session=True))
        if interrupted.is_set():
            return 0
        words = [] if options.duration is None else ['--duration', str(options.duration)]
        monitor = stack.enter_context(
            process('bahrs', 'monitor', '--require-data', *words, stdout=None,
                    stderr=logs['monitor']))
        wait_for(monitor, driver, interrupted)
        if driver.poll():
            return told(driver, logs['driver'])
        # What it says of a Ctrl-C in its first moment is of no interest.
        if interrupted.is_set() and monitor.returncode != NO_DATA:
            return 0
        return told(monitor, logs['monitor'])


def wait_for(monitor: subprocess.Popen, driver: subprocess.Popen, interrupted: Event) -> None:
    """Return when the monitor has ended, which it does after the driver, too."""
    while monitor.poll() is None:
        if interrupted.is_set():
            with contextlib.suppress(subprocess.TimeoutExpired):
                monitor.wait(END_TIMEOUT)
                return
            monitor.send_signal(signal.SIGINT)      # it was not there yet to hear the first
        with contextlib.suppress(subprocess.TimeoutExpired):
            driver.wait(0.2)
            monitor.send_signal(signal.SIGINT)
            monitor.wait(END_TIMEOUT)


def told(child: subprocess.Popen, log: TextIO) -> int:
    """Show what a child said, and return its exit status."""
    log.seek(0)
    sys.stderr.write(log.read())
    return child.returncode


@contextlib.contextmanager
def process(*words: str, stdout=subprocess.PIPE, **options) -> Iterator[subprocess.Popen]:
    """Run one of our own commands, and end it at the end."""
    child = subprocess.Popen([BIN / words[0], *words[1:]], stdout=stdout, text=True, **options)
    try:
        yield child
    finally:
        if child.poll() is None:
            child.send_signal(signal.SIGINT)
        try:
            child.wait(END_TIMEOUT)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()


if __name__ == '__main__':
    os.environ.setdefault('PYTHONUNBUFFERED', '1')
    sys.exit(main())
