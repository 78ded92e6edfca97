# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what ends a program, in a process of its own for the sake of its signals."""

import subprocess
import sys
import threading

from bahrs_driver.ending import Ending

LONG = 60.0         # s
# The signal is blocked in the main thread, so that the system hands it to the other one.
ELSEWHERE = """
import os, signal, threading, time
from bahrs_driver.ending import Ending
ended = Ending()
ended.listen_to(signal.SIGTERM)
threading.Thread(target=time.sleep, args=(3600,), daemon=True).start()
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGTERM)).start()
assert not ended.wait(0)
ended.wait()
print('ended')
"""


def test_somebody_says_so():
    """From another thread; it stays so, however often it is said."""
    ended = Ending()
    assert not ended.wait(0) and not ended.wait(0.01)
    threading.Timer(0.01, ended.tell).start()
    assert ended.wait(LONG) and ended.wait() and ended.wait(0)
    for _ in range(100_000):            # more than a pipe holds
        ended.tell()
    assert ended.wait(0)


def test_a_signal_that_another_thread_gets():
    """It wakes the main thread all the same."""
    done = subprocess.run([sys.executable, '-c', ELSEWHERE], capture_output=True, text=True,
                          timeout=LONG, check=False)
    assert (done.stdout, done.returncode) == ('ended\n', 0), done.stderr
