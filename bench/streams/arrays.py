# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print how many bytes of a recording become numpy arrays per second of processor time."""

from pathlib import Path
import sys

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.batch import Batch
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from throughput import best_cpu_time

BLOCK = 4_194_304       # bytes


def count(data: bytes) -> int:
    """Decode all messages into arrays, and return how many there are."""
    framer, codec = BlockFramer(BahrsFormat()), BahrsCodec()
    batch = Batch(codec.layouts_by_header)
    for start in range(0, len(data), BLOCK):
        for found in framer.feed(data[start:start + BLOCK]):
            if isinstance(found, FrameBlock):
                batch.add_block(found)
            else:
                batch.add(found)
    batch.add(framer.flush())
    kinds = {codec.layouts_by_header[header].message for header in batch.counts()}
    return sum(len(batch.take(kind)['offset']) for kind in kinds)


if __name__ == '__main__':
    recording = Path(sys.argv[1]).read_bytes()
    print(count(recording), len(recording) / best_cpu_time(lambda: count(recording)))
