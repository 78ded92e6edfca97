# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Feed a capture to a pipeline, as the port fed it to that of the driver."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.log_clock import LogClock, LogInstant
from bahrs_driver.clock import Instant
from bahrs_driver.pipeline import Event, Pipeline


class ChunkEvents(NamedTuple):
    """A chunk of a capture and its events; the chunk has no data at the end of a stream."""

    chunk: Chunk
    read: LogInstant
    events: Sequence[Event]
    disconnected: bool = False      # whether the connection was lost then, and another followed


def feed_capture(capture: Capture, pipeline: Pipeline, log_clock: LogClock
                 ) -> Iterator[ChunkEvents]:
    """Yield the events of each chunk, and those at the end of each stream."""
    last: ChunkEvents | None = None
    for chunk in capture.chunks():
        if last is None or chunk.connection_id != last.chunk.connection_id:
            if last:
                yield _end(last, pipeline, disconnected=True)
            pipeline.open(capture.byte_ns or 0)
        read = log_clock.observe(chunk.ros_ns or 0, chunk.raw_ns)
        last = ChunkEvents(chunk, read, pipeline.feed(
            chunk.data, Instant(read.raw_ns, read.ros_ns)))
        yield last
    if last:
        yield _end(last, pipeline)


def _end(last: ChunkEvents, pipeline: Pipeline, disconnected: bool = False) -> ChunkEvents:
    return ChunkEvents(last.chunk._replace(data=b''), last.read, pipeline.close(), disconnected)
