# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Inputs of the golden files: streams of bytes, and synthetic instants at which they were read.

Bytes come from the command line of the emulator or from the recording. Instants are computed
with integers and a seeded generator, so they are the same on every machine.
"""

import csv
from dataclasses import dataclass, field, replace
import functools
import io
import json
from pathlib import Path
import random
import tempfile
from typing import NamedTuple

from support.in_process import run_bahrs
from support.shared_files import shared_file

BYTE_NS = 86806                     # 10 bits at 115200 baud
RAW_START = 5_000_000_000_000       # ns
ROS_START = 1_700_000_000_400_000_000
READ_PERIOD = (4_000_000, 40_000_000)       # ns
READ_DELAY = 300_000                # ns
HOST_DRIFT = 20                     # ppm of both host clocks
SECOND = 1_000_000_000

PULSES = '--protocol-version 3 --drift-ppm 30 --wander-ppm 0.02 --sync-pulse-rate 1'
DAMAGED = ('--protocol-version 1 --crc byte --drift-ppm -45 --fault bit_flip=0.0004 '
           '--fault drop_byte=0.0002 --fault repeat_byte=0.0001 --fault insert_byte=0.0001 '
           '--fault break=0.002 --fault drop_frame=0.01 --fault repeat_frame=0.005')
INTEGRITY = '--protocol-version 3 --time-label same --motion steady-turn --debug-rate 10'
TITAN_M = '--sensor titan_m --first-fix 3 --gps-start 302400000 --sensors-len 0x2E'
POWER_CYCLE = ['7 power-cycle']
PHASES = ['2 integrity roll risk', '3 integrity magnetic_heading unavailable',
          '4 integrity specific_force risk', '5 integrity angular_rate_y reserved',
          '6 integrity all safe', '7 integrity all unavailable', '8 integrity all risk',
          '9 integrity pressure_height unavailable', '10 integrity all safe']
OTHER = {'frame_convention': 'ned', 'publish.incomplete': 'withhold',
         'stddev.specific_force': 0.05, 'stddev.velocity': 0.0, 'time.fixed_latency': 0.002,
         'magnetic_field.declination': 3.5}


class Read(NamedTuple):
    """The bytes of one read and the two host clocks after it, in ns."""

    data: bytes
    raw_ns: int
    ros_ns: int


@dataclass(frozen=True)
class Recipe:
    """How to make an input; with no options it is the recording."""

    seed: int
    options: str = ''
    scenario: list[str] = field(default_factory=list)
    duration: int = 12              # s
    openings: int = 1
    clock_step: int = 0             # ns by which ROS time is set in the middle
    sensor: str = 'bahrs'
    other: dict[str, object] = field(default_factory=dict)      # settings beside OTHER


RECIPES = {
    'recording': Recipe(10, duration=242),
    'pulses': Recipe(11, PULSES, other={'time.source': 'sync_pulse'}),
    'damaged': Recipe(12, DAMAGED, POWER_CYCLE, openings=3, clock_step=-250_000_000,
                      other={'integrity.risk_policy': 'pass'}),
    'integrity': Recipe(13, INTEGRITY, PHASES, clock_step=3_600_000_000_000,
                        other={'integrity.risk_policy': 'withhold'}),
    'titan_m': Recipe(14, TITAN_M, openings=2, sensor='titan_m',
                      other={'payload_order': 'little', 'stddev.temperature': 0.5}),
}


@dataclass(frozen=True)
class Input:
    """A stream of bytes of a device, and its reads by opening of the port."""

    sensor: str
    data: bytes
    openings: list[list[Read]]
    other: dict[str, object]        # settings that differ from the defaults

    def beginning(self, size: int) -> 'Input':
        """Return the first opening, up to about so many bytes."""
        reads = self.openings[0]
        count = max(1, len(reads) * size // len(self.data))
        return replace(self, data=self.data[:size], openings=[reads[:count]])


@functools.cache
def make_input(name: str) -> Input:
    """Return an input; skip the test if it is the recording and that is absent."""
    recipe = RECIPES[name]
    with tempfile.TemporaryDirectory() as folder:
        data = _emulated(recipe, Path(folder)) if recipe.options else shared_file(
            'data/bahrs_recording_v2.bin').read_bytes()
        file = Path(folder, 'stream.bin')
        file.write_bytes(data)
        _, table, _ = run_bahrs('decode', '--sensor', recipe.sensor, '--format', 'csv', file)
    reads = _reads(data, _arrivals(table, len(data), recipe.duration), recipe)
    size = -(-len(reads) // recipe.openings)
    return Input(recipe.sensor, data,
                 [reads[begin:begin + size] for begin in range(0, len(reads), size)],
                 {**OTHER, **recipe.other})


def _emulated(recipe: Recipe, folder: Path) -> bytes:
    output, scenario = folder / 'emulated.bin', folder / 'scenario.txt'
    scenario.write_text('\n'.join(recipe.scenario))
    status, _, error = run_bahrs(
        'emulate', *recipe.options.split(), '--seed', recipe.seed, '--duration', recipe.duration,
        '--scenario', scenario, '--output', output)
    assert status == 0, error
    return output.read_bytes()


def _arrivals(table: str, size: int, duration: int) -> list[tuple[int, int]]:
    """
    Return offset and start (ns) on the line of each frame, by offset.

    A frame starts at its device time, once the line is free. Frames without device time start at
    a time proportional to their offset if no frame has one, else behind the frame before.
    """
    rows = sorted((int(row['offset']), row.get('device_time_us', ''))
                  for row in csv.DictReader(io.StringIO(table, newline='')))
    timed = any(time for _, time in rows)
    arrivals, end, last, shift, previous = [], 0, 0, 0, 0
    for offset, text in rows:
        ready = 0 if timed else duration * SECOND * offset // size
        if text:
            time = 1000 * int(text)
            if time < last - SECOND:            # the device was switched off and on
                shift = end + SECOND - time
            last, ready = time, time + shift
        end = max(end + BYTE_NS * (offset - previous), ready)
        previous = offset
        arrivals.append((offset, end))
    return arrivals


def _reads(data: bytes, arrivals: list[tuple[int, int]], recipe: Recipe) -> list[Read]:
    """Return reads that each take the bytes that arrived by a random time, also half frames."""
    source = random.Random(recipe.seed)
    ends = [offset for offset, _ in arrivals[1:]] + [len(data)]
    reads, index, taken, time = [], 0, 0, arrivals[0][1]
    while taken < len(data):
        time += source.randrange(*READ_PERIOD)
        arrived = taken
        while index < len(arrivals):
            offset, start = arrivals[index]
            arrived = max(arrived, min(ends[index], offset + max(0, time - start) // BYTE_NS))
            if arrived < ends[index]:
                break
            index += 1
        if arrived > taken:
            now = time + source.randrange(READ_DELAY)
            now += now * HOST_DRIFT // 1_000_000
            step = recipe.clock_step if 2 * taken > len(data) else 0
            reads.append(Read(data[taken:arrived], RAW_START + now, ROS_START + now + step))
            taken = arrived
    return reads


def as_rules(settings: dict[str, object]) -> list[str]:
    """Return settings as options of the command line."""
    return [word for name, value in settings.items()
            for word in ('-p', f'{name}:={json.dumps(value)}')]
