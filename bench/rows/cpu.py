# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Processor time of the node beside a bare publisher, see `node_cpu`.

Bare publisher and node take turns; each figure is the median of three rounds, after a time to
settle. The idle rows have no publisher, so their limit is a share of the bare publisher, too.
"""

from collections.abc import Callable, Iterator
from statistics import median

from harness.row import at_most, Row
from node_cpu import measure_bare, measure_idle, measure_node, script
from support.waiting import wait_for

ROUNDS = 3
DURATION = 8.0          # s of a round
LIMITS = {'none': 2.4, '16': 1.7}
TIMERS = {'none': 'a read for almost each frame', '16': 'adapter with a timer of 16 ms'}


def measure() -> Iterator[Row]:
    """Measure the rows with and without subscribers and those of an idle node."""
    with script('counting_subscriber') as subscriber:
        assert wait_for(lambda: subscriber.lines), subscriber.text
        bare, *nodes = _take_turns(_bare, *(_node(timer) for timer in TIMERS))
    for (timer, words), node in zip(TIMERS.items(), nodes):
        yield Row(f'processor time of the node, all topics subscribed, {words}', node, '%',
                  at_most('ratio', LIMITS[timer]), at_most('ratio', 1.25), bare,
                  'bare publisher')
    yield _without_subscribers(nodes[0])
    for state, idle in zip(('open without data', 'missing'), measure_idle(DURATION)):
        yield Row(f'processor time of the node, port {state}', idle, '%',
                  at_most('ratio', 0.2), at_most('ours', 0.5), bare,
                  'bare publisher, subscribed')


def _without_subscribers(subscribed: float) -> Row:
    (node,) = _take_turns(_node('none'))
    return Row('the same without subscribers, a read for almost each frame', node, '%',
               at_most('ratio', 0.6), at_most('ratio', 0.2), subscribed, 'node, subscribed')


def _bare() -> float:
    return measure_bare(DURATION)


def _node(timer: str) -> Callable[[], float]:
    return lambda: measure_node(DURATION, timer)


def _take_turns(*measures: Callable[[], float]) -> list[float]:
    """Return the median of each measure over the rounds."""
    rounds = [[measure() for measure in measures] for _ in range(ROUNDS)]
    return [median(values) for values in zip(*rounds)]
