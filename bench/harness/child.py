# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Programs that run until they end: their output, processor time and peak memory.

A child begins with the memory of the process that starts it, as far as its peak is concerned. So
`usage.py`, which imports little, starts the program.
"""

import json
import os
from pathlib import Path
import subprocess
import sys
from typing import NamedTuple

USAGE = Path(__file__).with_name('usage.py')


class Usage(NamedTuple):
    """Processor time of a program and its children in s, and peak memory in MB (10^6 bytes)."""

    cpu: float
    peak: float


def output(*words: str | Path) -> str:
    """Return what a program prints; raise CalledProcessError if it fails."""
    return subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, text=True,
                          check=True).stdout


def usage(*words: str | Path) -> Usage:
    """Run a program, and return what it used; raise CalledProcessError if it fails."""
    reading, writing = os.pipe()
    with os.fdopen(reading) as file:
        try:
            subprocess.run(
                [sys.executable, '-S', str(USAGE), str(writing), *map(str, words)],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, pass_fds=[writing],
                check=True)
        finally:
            os.close(writing)
        cpu, peak = json.load(file)
    return Usage(cpu, peak)
