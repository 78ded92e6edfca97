# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A device that sends intact frames of random types: the node goes on, and does not grow."""

from pathlib import Path
import random

from bahrs_driver.protocol.bahrs.frames import build_frame
from support.devices import DIAGNOSTICS, status
from support.processes import driver, listening, wait_for

ROUNDS, FRAMES = 9, 4000


def resident(process):
    """Return the memory of a process, in MB."""
    pages = int(Path(f'/proc/{process.pid}/statm').read_text().split()[1])
    return pages * 4096 / 1e6


def frames(chance):
    """Return many frames of unknown versions."""
    return b''.join(build_frame(chance.randrange(4, 65536), chance.randrange(256), b'', 'byte')
                    for _ in range(FRAMES))


def unknown(ear):
    """Return how many frames of each unknown type are published."""
    latest = status(ear, 'Framing')
    text = {item.key: item.value for item in latest.values}['Frames of unknown type'] \
        if latest else 'none'
    return {} if text == 'none' else {
        name: int(count) for name, count in (pair.split(': ') for pair in text.split(', '))}


def test_frames_of_random_types_grow_neither_diagnostics_nor_memory(cable):
    """The 32 most frequent types are named, and the rest is summed up."""
    chance, counted, sizes = random.Random(1), 0, []
    with listening(DIAGNOSTICS) as ear, driver(cable.path) as node:
        assert wait_for(lambda: cable.is_open)
        for _ in range(ROUNDS):
            cable.write(frames(chance))
            counted += FRAMES
            # The last frame of all may be waiting for its end.
            assert wait_for(lambda: sum(unknown(ear).values()) >= counted - 1)
            sizes.append(resident(node))
        assert len(unknown(ear)) == 33 and unknown(ear)['other'] > 0.9 * counted
        assert max(sum(len(item.value) for item in found.values)
                   for array in ear.messages['/diagnostics'] for found in array.status) < 4000
    assert max(sizes[-3:]) < sizes[ROUNDS // 3] + 8
