# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The verbs of `bahrs` on a recording of 100 MB, in processor time of the whole program.

The floor is the time that Python needs to touch each frame of the same recording, see
`streams/floor.py`, so that a limit holds on any machine.
"""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
import sys
import tempfile

from harness.child import output, Usage, usage
from harness.recording import BAHRS, FULL, megabytes, PART, recording
from harness.row import at_most, Bound, Row
from rows.stream import STREAMS

RUNS = 3
EMULATED = 2 * PART     # s of the device's time that `emulate` is measured on


@cache
def floor() -> float:
    """Return the floor for the recording, in s."""
    return float(output(sys.executable, STREAMS / 'floor.py', recording()))


def decode() -> Iterator[Row]:
    """Measure `bahrs decode`, the summary."""
    used = min(usage(BAHRS, 'decode', recording()) for _ in range(RUNS))
    yield _time('decode', used.cpu, at_most('ratio', 1.1), 2)


def report() -> Iterator[Row]:
    """Measure `bahrs report`, and its memory."""
    with tempfile.TemporaryDirectory() as folder:
        runs = [usage(BAHRS, 'report', recording(), '-o', f'{folder}/{index}.html')
                for index in range(2)]
    yield _time('report', min(used.cpu for used in runs), at_most('ratio', 5), 6)
    yield Row('`bahrs report` of 100 MB, peak memory', max(used.peak for used in runs), 'MB',
              at_most('ours', 450), at_most('ours', 400))


def convert() -> Iterator[Row]:
    """Measure `bahrs convert`, and its memory beside that for a recording a tenth as long."""
    part, whole = _convert(recording(PART)), _convert(recording())
    yield _time('convert', whole.cpu, at_most('ratio', 160), 60)
    yield Row('`bahrs convert` of 100 MB, peak memory', whole.peak, 'MB', at_most('ratio', 1.2),
              at_most('ratio', 1.1), part.peak, '10 MB')


def emulate() -> Iterator[Row]:
    """Measure `bahrs emulate --output`."""
    with tempfile.TemporaryDirectory() as folder:
        start, part = (min(_emulate(Path(folder, f'{index}.bin'), duration)
                           for index in range(2)) for duration in (1, EMULATED))
    cost = start.cpu + (part.cpu - start.cpu) * FULL / EMULATED
    yield _time('emulate', cost, at_most('ratio', 60), 30,
                f'into a file, computed from {megabytes(recording()) * EMULATED / FULL:.0f} MB')


def _time(verb: str, cpu: float, limit: Bound, target: float, note: str = '') -> Row:
    return Row(f'`bahrs {verb}` of 100 MB', cpu, 's', limit, at_most('ours', target), floor(),
               'touching each frame', note)


def _convert(path: Path) -> Usage:
    with tempfile.TemporaryDirectory() as folder:
        return usage(BAHRS, 'convert', path, f'{folder}/bag')


def _emulate(path: Path, duration: int) -> Usage:
    return usage(BAHRS, 'emulate', '--output', path, '--force', '--duration', str(duration))
