# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Measure the errors of stamps in a subscriber, with a real port, driver and middleware."""

from collections.abc import Iterator
import json
from pathlib import Path
import tempfile
import time

from clock_floor import minimum_delays
from clock_table import figures
from sensor_msgs.msg import Imu
from support.domain import use_own_domain
from support.processes import driver, listening, running, wait_for

NODE_HEADER = ('latency timer', 'time.source', 'stamps', 'p50', 'p99', 'max', 'wander p99',
               'wander max')
TIMERS = ('16', 'packets', '1', 'none')
SECONDS = {'arrival': 18, 'device': 60, 'sync_pulse': 18}
SETTLED = 10.0      # s
SEED = 101
PERIOD, EARLIEST = 5_000_000, 1_000_000      # ns


def measured() -> Iterator[tuple[object, ...]]:
    """Yield a row per adapter and source, and the floor."""
    use_own_domain()
    for timer in TIMERS:
        floor = minimum_delays(timer)
        yield timer, 'floor', str(len(floor)), *figures(floor)
        for source in ('arrival', 'device', 'sync_pulse'):
            errors = list(run(timer, source))
            yield timer, source, str(len(errors)), *figures(errors)


def run(timer: str, source: str) -> Iterator[float]:
    """Yield the errors of a run in us, after the clock has settled."""
    with tempfile.TemporaryDirectory() as folder:
        port, truth_file = f'{folder}/port', Path(folder, 'truth.jsonl')
        with listening({'imu/data_raw': Imu}) as listener, running(
                'bahrs', 'emulate', '--link', port, '--wait', '--duration', str(SECONDS[source]),
                '--truth', str(truth_file), '--latency-timer', timer, '--seed', str(SEED),
                '--drift-ppm', '30', '--wander-ppm', '0.02', '--sync-pulse-rate', '1') as device:
            assert wait_for(lambda: device.lines)
            with driver(port, time__source=source):
                device.wait(SECONDS[source] + 60)
                time.sleep(1.0)         # the driver notices that its port is gone
        received = listener.messages['imu/data_raw']
        lines = (json.loads(line) for line in truth_file.read_text().splitlines())
        truths = [line for line in lines if line.get('message') == 'inertial']
    times = [truth['host_unix_ns'] for truth in truths]
    stamps = [item.header.stamp.sec * 10 ** 9 + item.header.stamp.nanosec for item in received]
    yield from errors_of(stamps, times, SETTLED)


def errors_of(stamps: list[int], times: list[int], settled: float = 0.0) -> Iterator[float]:
    """Yield the errors in us of stamps in ns, beginning some seconds after the first sample."""
    begin = times[0] + settled * 1e9
    for stamp, time_ns in zip(stamps, times[_missed(stamps, times):]):
        if time_ns >= begin:
            yield (stamp - time_ns) / 1000


def _missed(stamps: list[int], truths: list[int]) -> int:
    """
    Return how many samples were sent before the first one received.

    No stamp is much earlier than its sample, and the best stamps are less than a period later. So
    the largest count for which this holds is the right one.
    """
    least = min(stamp - truth for stamp, truth in zip(stamps, truths))
    return max(0, (least + EARLIEST) // PERIOD)
