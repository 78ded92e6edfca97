# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the event that ends a program, in processes of their own for the sake of signals."""

import signal
import subprocess
import sys
import threading

from bahrs_driver.process.shutdown_event import ShutdownEvent
import pytest

LONG = 60.0         # s
PREFIX = """
import os, signal, sys, threading, time
from bahrs_driver.process.shutdown_event import end_process, ShutdownEvent
event = ShutdownEvent()
"""
# The signal is blocked in the main thread: the system delivers it to the other one.
ANOTHER_THREAD = PREFIX + """
event.install_signal_handlers()
threading.Thread(target=time.sleep, args=(3600,), daemon=True).start()
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGTERM)).start()
assert not event.wait(0)
event.wait()
print('ended')
"""
EACH_SIGNAL = PREFIX + """
event.install_signal_handlers()
os.kill(os.getpid(), int(sys.argv[1]))
assert event.wait()
threading.Thread(target=time.sleep, args=(3600,)).start()
print('ended')
os.kill(os.getpid(), int(sys.argv[1]))
end_process(0)
"""
NOHUP = PREFIX + """
signal.signal(signal.SIGHUP, signal.SIG_IGN)
event.install_signal_handlers()
os.kill(os.getpid(), signal.SIGHUP)
assert not event.wait(0)
print('ended')
"""
MANY_DESCRIPTORS = """
import os, resource
resource.setrlimit(resource.RLIMIT_NOFILE, (4096, 4096))
opened = [os.open(os.devnull, os.O_RDONLY) for _ in range(1100)]
""" + PREFIX + """
event.set()
assert event._read_end >= 1024 and event.wait(1)
print('ended')
"""
# The second one never lets another thread of Python run.
HANG = 'time.sleep(3600)', 'import ctypes; ctypes.PyDLL(None).sleep(3600)'


def run(code, *words):
    """Run Python code as a process."""
    return subprocess.run([sys.executable, '-c', code, *map(str, words)], capture_output=True,
                          text=True, timeout=LONG, check=False)


def test_set():
    """From another thread; it stays set, and can be set again."""
    event = ShutdownEvent()
    assert not event.wait(0) and not event.wait(0.01) and not event.is_set()
    threading.Timer(0.01, event.set).start()
    assert event.wait(LONG) and event.wait() and event.is_set()
    for _ in range(100_000):            # more than a pipe holds
        event.set()
    assert event.is_set()


@pytest.mark.parametrize('code', [ANOTHER_THREAD, NOHUP, MANY_DESCRIPTORS])
def test_in_a_process(code):
    """Signals to another thread or ignored by nohup, and many open files."""
    done = run(code)
    assert (done.stdout, done.returncode) == ('ended\n', 0), done.stderr


@pytest.mark.parametrize('kind', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_each_signal(kind):
    """It sets the event, and a second one does not disturb the exit."""
    done = run(EACH_SIGNAL, int(kind))
    assert (done.stdout, done.returncode) == ('ended\n', 0), done.stderr


@pytest.mark.parametrize('hang', HANG)
def test_a_process_that_hangs(hang):
    """It ends with status 0."""
    done = run(f'{PREFIX}\nevent.limit_exit_time(0.1)\nevent.set()\ntime.sleep(0.05)\n{hang}')
    assert (done.returncode, done.stderr) == (0, '')
