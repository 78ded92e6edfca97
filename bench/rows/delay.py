# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Latency from the last byte of a frame to the callback of a subscriber, see `latency`.

Bare publisher and node take turns; each figure is the best of the rounds, because whatever else
runs on the machine makes the slowest hundredth many times slower.
"""

from collections.abc import Iterator
from statistics import quantiles

from harness.row import at_most, Row
from latency import measure_bare, measure_node

ROUNDS = 4
DURATION = 10.0         # s of a round
BOUNDS = {'p50': (49, 0.15, 2.8), 'p99': (98, 0.5, 3.0)}      # index, target above bare, limit


def measure() -> Iterator[Row]:
    """Measure in turns."""
    rounds = [(quantiles(measure_bare(DURATION), n=100), quantiles(measure_node(DURATION), n=100))
              for _ in range(ROUNDS)]
    for name, (index, target, limit) in BOUNDS.items():
        bare, node = (min(values[index] for values in each) for each in zip(*rounds))
        yield Row(f'last byte of a frame to the callback of a subscriber, {name}', node, 'ms',
                  at_most('ratio', limit), at_most('difference', target), bare,
                  'bare publisher to subscriber')
