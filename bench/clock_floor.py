# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure the delay of this machine, from a write into a pseudo-terminal to its reader.

No reader of a port can be more accurate. Of each half second only the minimum is used, as by the
clock.
"""

from collections.abc import Iterator
import os
import pty
import select
import subprocess
import sys
import time
import tty

PERIODS = {'16': 0.016, 'packets': 0.0625, '1': 0.001, 'none': 0.0031}     # s between two bursts
SECONDS = 20.0
BUCKET = 500_000_000    # ns
WRITER = """
import os, sys, time
period, due = float(sys.argv[1]), time.monotonic() + 0.1
end = due + float(sys.argv[2])
while due < end:
    time.sleep(max(0.0, due - 0.0002 - time.monotonic()))
    while time.monotonic() < due:
        pass
    os.write(1, time.monotonic_ns().to_bytes(8, 'little'))
    due += period
"""


def minimum_delays(timer: str) -> list[float]:
    """Return the minimum delay of each half second in us, with bursts like those of an adapter."""
    near, far = pty.openpty()
    tty.setraw(far)
    words = [sys.executable, '-c', WRITER, str(PERIODS[timer]), str(SECONDS)]
    least: dict[int, int] = {}
    with subprocess.Popen(words, stdout=near) as child:
        for sent, now in _reads(far, child):
            bucket = sent // BUCKET
            least[bucket] = min(least.get(bucket, now - sent), now - sent)
    os.close(near)
    os.close(far)
    return [delay / 1000 for _, delay in sorted(least.items())][1:-1]


def _reads(port: int, child: subprocess.Popen[bytes]) -> Iterator[tuple[int, int]]:
    while child.poll() is None:
        if select.select([port], [], [], 0.5)[0]:
            now = time.monotonic_ns()
            yield int.from_bytes(os.read(port, 4096)[-8:], 'little'), now
