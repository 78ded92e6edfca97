# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Recording to numpy arrays beside a program in C that finds the frames of the same file."""

from collections.abc import Iterator
import shutil
import sys

from harness.child import output
from harness.recording import FOLDER, recording
from harness.row import at_least, Row
from rows.stream import STREAMS


def measure() -> Iterator[Row]:
    """Measure bytes in memory to arrays; the reference only finds frames and checks CRCs."""
    path = recording()
    frames, rate = map(float, output(sys.executable, STREAMS / 'arrays.py', path).split())
    reference = None
    if shutil.which('cc'):
        program = FOLDER / 'reference'
        output('cc', '-O2', '-o', program, STREAMS / 'reference.c')
        found, reference = map(float, output(program, path).split())
        assert found == frames, f'{found:.0f} frames in C, {frames:.0f} here'
        reference /= 1e6
    yield Row('recording to numpy arrays', rate / 1e6, 'MB/s', at_least('ratio', 0.06),
              at_least('ours', 200), reference, 'C, frames and CRCs only, -O2'
              if reference else 'no C compiler')
