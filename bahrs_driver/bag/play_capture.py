# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Feed a capture to a pipeline, as the port fed it to that of the driver."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.log_clock import LogClock, Moment
from bahrs_driver.clock import Instant
from bahrs_driver.pipeline import Event, Pipeline


class PlayedChunk(NamedTuple):
    """A chunk of a capture and its events; at the end of a stream the chunk has no data."""

    chunk: Chunk
    moment: Moment                  # of the read
    events: Sequence[Event]
    lost: bool = False              # whether the port was lost then, and opened again


def play_capture(capture: Capture, pipeline: Pipeline, log_clock: LogClock
                 ) -> Iterator[PlayedChunk]:
    """Yield the events of each chunk, and those at the end of each stream."""
    last: Chunk | None = None
    moment = Moment(0, 0, 0)
    for chunk in capture.chunks():
        if last is None or chunk.opening != last.opening:
            if last:
                yield PlayedChunk(last._replace(data=b''), moment, pipeline.close(), lost=True)
            pipeline.open(capture.byte_ns or 0)
        last = chunk
        moment = log_clock.observe(chunk.read_at or 0, chunk.raw_at)
        yield PlayedChunk(chunk, moment, pipeline.feed(
            chunk.data, Instant(moment.raw_ns, moment.ros_ns)))
    if last:
        yield PlayedChunk(last._replace(data=b''), moment, pipeline.close())
