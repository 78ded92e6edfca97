# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Streaming decode to typed messages beside two peers, each on a stream of its own encoder."""

from collections.abc import Iterator
from pathlib import Path
import sys

from harness.child import output
from harness.recording import ROOT
from harness.row import at_least, Row

STREAMS = ROOT / 'bench' / 'streams'
PEERS = ROOT / '.venv-peers' / 'bin' / 'python'
ROUNDS = 3


def measure() -> Iterator[Row]:
    """Measure all in turns; each figure is the best of the rounds, in thousands per second."""
    rounds = [(_rate(sys.executable, 'bahrs'), _rate(PEERS, 'ubx'), _rate(PEERS, 'mavlink'))
              for _ in range(ROUNDS)]
    ours, ubx, mavlink = map(max, zip(*rounds))
    what = 'streaming decode to typed messages, chunks of 4 KiB'
    yield Row(what, ours, 'k/s', at_least('ratio', 12), at_least('ratio', 15), ubx, 'pyubx2')
    yield Row(what, ours, 'k/s', at_least('ratio', 1.75), at_least('ratio', 3), mavlink,
              'pymavlink')


def _rate(python: str | Path, name: str) -> float:
    return float(output(python, STREAMS / f'{name}.py')) / 1e3
