# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Measure the errors of the stamps of a flight, live and converted from its raw bytes."""

from collections.abc import Iterator
import json
from pathlib import Path
import tempfile

from bahrs_driver.clock import Clock, SampleClock
from bahrs_driver.protocol.bahrs.roles import ROLES
from clock_methods import Stamp, stamps_of_read
from clock_node import errors_of
from clock_simulation import BYTE_TIME, Case, Read, Simulation
from clock_table import figures
from rosbags.rosbag2 import Reader
from rosbags.typesys import get_typestore, Stores
from support.domain import use_own_domain
from support.processes import driver, running, wait_for

CONVERTED_HEADER = ('latency timer', 'method', 'stamps', 'p50', 'p99', 'max', 'wander p99',
                    'wander max')
TIMERS = ('16', 'packets', '1', 'none')
SECONDS = 20
SEED = 102
TOPIC = '/imu/data_raw'
LONG = 120.0


def smoothed(case: Case, seed: int) -> list[Stamp]:
    """Return the stamps of a conversion of a simulated case."""
    simulation, smoothing = Simulation(case, seed), SampleClock(ROLES).smoothing()
    reads = list(simulation.reads())
    _stamped(simulation, reads, smoothing.first_pass)
    return _stamped(simulation, reads, smoothing.second_pass())


def _stamped(simulation: Simulation, reads: list[Read], clock: Clock) -> list[Stamp]:
    stamps = []
    clock.begin(BYTE_TIME)
    for now, received, messages in reads:
        clock.observe_read(now, received)
        stamps += stamps_of_read(simulation, now, clock.stamp(messages))
    return stamps


def through_the_node() -> Iterator[tuple[object, ...]]:
    """Yield a row per adapter, live and converted, with the first seconds."""
    use_own_domain()
    for timer in TIMERS:
        for method, errors in _run(timer):
            yield timer, method, str(len(errors)), *figures(errors)


def _run(timer: str) -> Iterator[tuple[str, list[float]]]:
    with tempfile.TemporaryDirectory() as folder:
        port, truth_file, live, made = (f'{folder}/{name}' for name in (
            'port', 'truth.jsonl', 'live', 'made'))
        with running('bahrs', 'emulate', '--link', port, '--wait', '--duration', str(SECONDS),
                     '--truth', truth_file, '--latency-timer', timer, '--seed', str(SEED),
                     '--drift-ppm', '30', '--wander-ppm', '0.02') as device:
            assert wait_for(lambda: device.lines)
            with driver(port, publish__raw='true') as node, running(
                    'bahrs', 'record', '-o', live) as recorder:
                device.wait(SECONDS + LONG)
                assert wait_for(lambda: 'is gone' in node.text, LONG)
                assert recorder.end() == 0
        with running('bahrs', 'convert', live, made) as converter:
            assert converter.wait(LONG) == 0
        lines = map(json.loads, Path(truth_file).read_text().splitlines())
        times = [line['host_unix_ns'] for line in lines if line.get('message') == 'inertial']
        for method, bag in (('live', live), ('**converted**', made)):
            yield method, list(errors_of(_stamps(Path(bag)), times))


def _stamps(bag: Path) -> list[int]:
    types = get_typestore(Stores.ROS2_JAZZY)
    with Reader(bag) as reader:
        wanted = [item for item in reader.connections if item.topic == TOPIC]
        found = [types.deserialize_cdr(data, item.msgtype).header.stamp
                 for item, _, data in reader.messages(wanted)]
    return [stamp.sec * 10 ** 9 + stamp.nanosec for stamp in found]
