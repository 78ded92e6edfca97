# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of feeding a capture to a pipeline."""

from pathlib import Path

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.feed_capture import feed_capture
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.clock import ArrivalClock
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import SyncPulseTime
from bahrs_driver.protocol.framing import Framer

FRAMES = [BahrsCodec().encode(SyncPulseTime(i, 1000 * i), 3) for i in range(4)]
SIZE, BYTE_NS, START = len(FRAMES[0]), 86_805, 1_700_000_000_000_000_000
UNFINISHED = b'NE\x03\x00\xf3'      # the header of a page, which hides the frame behind it


class Chunks(Capture):
    """A capture of given chunks."""

    byte_ns = BYTE_NS

    def __init__(self, *chunks):
        super().__init__(Path('flight'), 0)
        self._chunks = chunks

    def chunks(self):
        """Return the chunks."""
        return iter(self._chunks)


def feed(*chunks):
    """Return the pipeline, and the events of each chunk."""
    pipeline = Pipeline(Framer(BahrsFormat()), BahrsCodec(), ArrivalClock())
    return pipeline, list(feed_capture(Chunks(*chunks), pipeline, LogClock()))


def sequences(fed):
    """Return the sequence numbers of the messages of each chunk."""
    return [[event.message.sequence for event in item.events] for item in fed]


def test_messages_belong_to_the_chunk_that_completes_them():
    """The time of its read stamps them; the end of the capture is a chunk without data."""
    _, fed = feed(Chunk(FRAMES[0] + FRAMES[1][:5], START), Chunk(FRAMES[1][5:], START + 1000))
    assert sequences(fed) == [[0], [1], []]
    assert fed[0].events[0].stamp_ns == START - (SIZE + 5) * BYTE_NS
    assert [item.read.ros_ns for item in fed] == [START, START + 1000, START + 1000]
    assert [item.chunk.data for item in fed] == [FRAMES[0] + FRAMES[1][:5], FRAMES[1][5:], b'']
    assert not any(item.disconnected for item in fed)


def test_each_connection_is_a_stream():
    """A frame does not continue in the next stream; the end delivers a frame inside another."""
    pipeline, fed = feed(
        Chunk(FRAMES[0] + UNFINISHED + FRAMES[1], START, connection_id=1),
        Chunk(FRAMES[2][:9], START + 1, connection_id=3),
        Chunk(FRAMES[2][9:] + FRAMES[3], START + 2, connection_id=4))
    assert sequences(fed) == [[0], [1], [], [], [3], []]
    assert [item.disconnected for item in fed] == [False, True, False, True, False, False]
    assert pipeline.counters.streams == 3


def test_an_empty_capture():
    """It has no stream."""
    pipeline, fed = feed()
    assert fed == [] and pipeline.counters.streams == 0
