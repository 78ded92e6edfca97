# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Latency from the last byte of a frame to the callback of a subscriber, see `latency`."""

from collections.abc import Iterator
from statistics import median, quantiles

from harness.row import at_most, Row
from latency import measure_bare, measure_node

ROUNDS = 3
DURATION = 12.0         # s of a round
BOUNDS = {'p50': (49, 0.15, 2.8), 'p99': (98, 0.5, 3.0)}      # index, target above bare, limit


def measure() -> Iterator[Row]:
    """Measure both in turns; each figure is the median of the rounds."""
    rounds = [(quantiles(measure_bare(DURATION), n=100), quantiles(measure_node(DURATION), n=100))
              for _ in range(ROUNDS)]
    for name, (index, target, limit) in BOUNDS.items():
        bare, node = (median(values[index] for values in each) for each in zip(*rounds))
        yield Row(f'last byte of a frame to the callback of a subscriber, {name}', node, 'ms',
                  at_most('ratio', limit), at_most('difference', target), bare,
                  'bare publisher to subscriber')
