# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Count the messages of a stream."""

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from bahrs_driver.devices.stream_decoder import AnyDecoder
from bahrs_driver.protocol.block_format import BlockFormat
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import Frame, FramingCounters
from bahrs_driver.reprocess.decode import decode_stream
from bahrs_driver.reprocess.decoding_faults import DecodingFaults


class StreamSummary(NamedTuple):
    """Counts of messages by name, and the counters of the bytes."""

    counts: Counter[str]
    bytes_received: int
    framing: FramingCounters


def summarize(chunks: Iterable[bytes], decoder: AnyDecoder,
              faults: DecodingFaults) -> StreamSummary:
    """Count the messages of a stream, without decoding them if the device allows it."""
    blocks = decoder.block_format()
    if blocks:
        return _count_frames(chunks, *blocks)
    counts = Counter(message.NAME for _, message in decode_stream(chunks, decoder, faults))
    counters = decoder.pipeline.counters
    return StreamSummary(counts, counters.bytes_received, counters.framing)


def _count_frames(chunks: Iterable[bytes], frame_format: BlockFormat,
                  names: dict[bytes, str]) -> StreamSummary:
    framer, counts, first = BlockFramer(frame_format), Counter[str](), dict[str, int]()

    def add(found: FrameBlock | list[Frame]) -> None:
        if isinstance(found, FrameBlock):
            counts[names[found.header]] += len(found.offsets)
            first.setdefault(names[found.header], int(found.offsets[0]))
        else:
            for offset, data, _ in found:
                name = names[data[:frame_format.header_size]]
                counts[name] += 1
                first.setdefault(name, offset)

    for chunk in chunks:
        for found in framer.feed(chunk):
            add(found)
    add(framer.flush())
    # In the order of the first messages, as counted one by one.
    ordered = {name: counts[name] for name in sorted(counts, key=first.__getitem__)}
    return StreamSummary(Counter(ordered), framer.framer.received, framer.framer.counters)
