# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Stamp errors in a subscriber: emulator, pseudo-terminal, driver, middleware, all real."""

from collections.abc import Iterator
import json
import os
from pathlib import Path
import tempfile
import time
from typing import Any

from clock_table import figures
from processes import driver, listening, running, wait_for
from sensor_msgs.msg import Imu

NODE_HEADER = ('latency timer', 'time.source', 'stamps', 'p50', 'p99', 'max', 'wander p99',
               'wander max')
TIMERS = ('16', 'packets', '1', 'none')
SECONDS, SETTLED = 22, 10.0     # s
SEED = 101
LONGEST_DELAY = 400             # samples that may be missed before the subscriber is found


def measured() -> Iterator[tuple[object, ...]]:
    """Yield rows: each adapter with each source."""
    os.environ['ROS_DOMAIN_ID'] = '77'
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    for timer in TIMERS:
        for source in ('arrival', 'device', 'sync_pulse'):
            errors = list(run(timer, source))
            yield timer, source, str(len(errors)), *figures(errors)


def run(timer: str, source: str) -> Iterator[float]:
    """Yield the errors in us of a run, once settled."""
    with tempfile.TemporaryDirectory() as folder:
        port, truth_file = f'{folder}/port', Path(folder, 'truth.jsonl')
        with listening({'imu/data_raw': Imu}) as ear, running(
                'bahrs', 'emulate', '--link', port, '--wait', '--duration', str(SECONDS),
                '--truth', str(truth_file), '--latency-timer', timer, '--seed', str(SEED),
                '--drift-ppm', '30', '--wander-ppm', '0.02', '--sync-pulse-rate', '1') as device:
            assert wait_for(lambda: device.lines)
            with driver(port, time__source=source):
                device.wait(SECONDS + 15)
                time.sleep(1.0)         # the driver notices that its port is gone
        heard = ear.heard['imu/data_raw']
        lines = (json.loads(line) for line in truth_file.read_text().splitlines())
        truths = [line for line in lines if line.get('message') == 'inertial']
    missed = _missed(heard, truths)
    begin = truths[0]['host_unix_ns'] + SETTLED * 1e9
    for message, truth in zip(heard, truths[missed:]):
        if truth['host_unix_ns'] > begin:
            stamp = message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec
            yield (stamp - truth['host_unix_ns']) / 1000


def _missed(heard: list[Any], truths: list[Any]) -> int:
    """Return how many samples were sent before the first one heard, by what is in them."""
    def misfit(missed: int) -> float:
        pairs = list(zip(heard, truths[missed:]))
        return sum((message.linear_acceleration.x - truth['specific_force'][0]) ** 2
                   + (10 * (message.angular_velocity.x - truth['angular_rate'][0])) ** 2
                   for message, truth in pairs) / len(pairs)
    return min(range(LONGEST_DELAY), key=misfit)
