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

BIN = Path(sys.executable).parent
END_TIMEOUT = 5.0       # s


def main() -> int:
    """Run until the time is up, Ctrl-C, or the driver ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--port', help='use this port instead of an emulated device')
    parser.add_argument('--sensor', default='bahrs', help='which device (default: %(default)s)')
    parser.add_argument('--duration', help='end after so many seconds')
    options = parser.parse_args()
    # Ctrl-C reaches all children too; they end themselves and we wait for them.
    signal.signal(signal.SIGINT, lambda *_: None)
    # Nobody else would end them then.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        port = options.port
        if port is None:
            port = f'{folder}/bahrs'
            emulator = stack.enter_context(
                process('bahrs', 'emulate', '--sensor', options.sensor, '--link', port, '--wait',
                        stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
            emulator.stdout.readline()      # it prints the port when there is one
        with open(f'{folder}/driver.log', 'w+') as log:
            driver = stack.enter_context(
                process('driver_node', '--ros-args', '-p', f'port:={port}',
                        '-p', f'sensor:={options.sensor}', stderr=log))
            words = ['--duration', options.duration] if options.duration else []
            monitor = stack.enter_context(process('bahrs', 'monitor', *words, stdout=None))
            return wait_for(monitor, driver, log)


def wait_for(monitor: subprocess.Popen, driver: subprocess.Popen, log) -> int:
    """Return the exit status of the first that ends; show what the driver said if it failed."""
    while monitor.poll() is None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            driver.wait(0.2)
            monitor.send_signal(signal.SIGINT)
            monitor.wait(END_TIMEOUT)
    if driver.poll():
        log.seek(0)
        sys.stderr.write(log.read())
        return driver.returncode
    return monitor.returncode


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
