# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the pipeline, with the frames of a BAHRS and clocks that are given or scripted."""

from bahrs_driver.clock import ArrivalClock, Instant, Stamped
from bahrs_driver.pipeline import DecodingFault, Notice, Pipeline
from bahrs_driver.pipeline.pipeline import SAMPLE_SIZE
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import NavigationTime, SyncPulseTime
from bahrs_driver.protocol.framing import Framer
from hypothesis import given, strategies as st
import pytest
from support.independent import chunk_sizes, chunks, properties, stream_frames

FRAMES = [BahrsCodec().encode(SyncPulseTime(i, 1000 * i), 3) for i in range(6)]
SIZE = len(FRAMES[0])
NOW = Instant(3_000_000, 10_000_000)
# The header of a page announces more bytes than follow it, and so hides the frames behind it.
UNFINISHED = b'NE\x03\x00\xf3'


def make_pipeline(decoder=None, clock=None):
    """Return a pipeline for a BAHRS."""
    return Pipeline(Framer(BahrsFormat()), decoder or BahrsCodec(), clock)


def sequences(events):
    """Return the sequence numbers of the messages among events."""
    return [event.message.sequence for event in events if isinstance(event, Stamped)]


class FailingDecoder(BahrsCodec):
    """A decoder that fails on frames with some sequence numbers, and has no message for others."""

    def __init__(self, failing=(), without=()):
        super().__init__()
        self._failing, self._without = failing, without

    def decode(self, frame, now=0):
        """Decode, or raise KeyError, or return None."""
        message = super().decode(frame)
        if message.sequence in self._failing:
            raise KeyError(message.sequence)
        return None if message.sequence in self._without else message


class ScriptedClock(ArrivalClock):
    """A clock that holds all messages until the end, and fails or gives notice if asked to."""

    def __init__(self):
        super().__init__()
        self.held, self.notices = [], []
        self.byte_times, self.reads = [], []
        self.error = None

    def begin(self, byte_time):
        """Forget what is held."""
        super().begin(byte_time)
        self.held = []
        if hasattr(self, 'byte_times'):
            self.byte_times.append(byte_time)

    def observe_read(self, now, received):
        """Keep the arguments."""
        super().observe_read(now, received)
        self.reads.append((now, received))

    def stamp(self, messages):
        """Hold messages."""
        stamped = super().stamp(messages)
        if self.error:
            error, self.error = self.error, None
            raise error
        self.held += stamped
        return []

    def end(self):
        """Return all messages."""
        held, self.held = self.held, []
        return held

    def take_notices(self):
        """Return the notices."""
        notices, self.notices = self.notices, []
        return notices


def test_a_read_completes_messages_in_their_order():
    """Each comes with its frame and its stamp."""
    pipeline = make_pipeline(clock=ArrivalClock())
    pipeline.open(1000)
    events = pipeline.feed(FRAMES[0] + FRAMES[1] + FRAMES[2][:3], NOW)
    assert [(event.message.sequence, event.frame.offset, event.stamp_ns) for event in events] == [
        (0, 0, 10_000_000 - 1000 * (2 * SIZE + 3)), (1, SIZE, 10_000_000 - 1000 * (SIZE + 3))]


def test_messages_are_unstamped_without_a_clock():
    """No instant is needed then."""
    assert [event.stamp_ns for event in make_pipeline().feed(FRAMES[0])] == [0]


def test_an_empty_feed_completes_nothing():
    """It counts nothing, either."""
    pipeline = make_pipeline()
    pipeline.open()
    assert not pipeline.feed(b'') and not pipeline.close()
    assert (pipeline.received, pipeline.counters.bytes_received) == (0, 0)
    assert sequences(pipeline.feed(FRAMES[0])) == [0]


@properties(100)
@given(st.lists(stream_frames(), max_size=8), chunk_sizes())
def test_chunks_make_no_difference(frames, sizes):
    """However the bytes are cut, the same events come, with the same counts."""
    stream = b''.join(frames) + UNFINISHED + b''.join(frames[:2])
    whole, cut = make_pipeline(), make_pipeline()
    expected = [*whole.feed(stream), *whole.close()]
    assert [event for chunk in chunks(stream, sizes) for event in cut.feed(chunk)] + list(
        cut.close()) == expected
    assert cut.counters == whole.counters
    assert len(expected) >= len(frames)


@given(st.sets(st.integers(0, 5)), st.integers(1, 2 * SIZE))
def test_a_decoder_that_fails_loses_that_frame_only(failing, size):
    """The fault is an event that names frame and exception."""
    stream, pipeline = b''.join(FRAMES), make_pipeline(FailingDecoder(failing))
    events = [event for start in range(0, len(stream), size)
              for event in pipeline.feed(stream[start:start + size], NOW)]
    assert sequences(events) == [number for number in range(6) if number not in failing]
    faults = [event for event in events if isinstance(event, DecodingFault)]
    assert [fault.frame.data for fault in faults] == [FRAMES[number] for number in sorted(failing)]
    assert all(isinstance(fault.error, KeyError) for fault in faults)


def test_a_frame_may_have_no_message():
    """It is counted as a frame all the same."""
    pipeline = make_pipeline(FailingDecoder(without=(1,)))
    assert sequences(pipeline.feed(b''.join(FRAMES[:3]))) == [0, 2]
    assert pipeline.counters.framing.frames == 3


def test_the_decoder_gets_the_time_of_the_read():
    """On the clock that is never set."""
    times = []

    class Timed(BahrsCodec):
        def decode(self, frame, now=0):
            times.append(now)
            return super().decode(frame)

    pipeline = make_pipeline(Timed())
    pipeline.feed(FRAMES[0], Instant(7, 700))
    pipeline.feed(UNFINISHED + FRAMES[1], Instant(9, 900))
    pipeline.close()
    assert times == [7, 9]


def test_the_clock_gets_each_read():
    """With the count of all bytes up to it."""
    clock = ScriptedClock()
    pipeline = make_pipeline(clock=clock)
    for data in (FRAMES[0], b'', b'noise'):
        pipeline.feed(data, NOW)
    assert clock.reads == [(NOW, SIZE), (NOW, SIZE), (NOW, SIZE + 5)]


def test_close_returns_what_was_waiting():
    """Behind a candidate that is incomplete, and in the clock."""
    clock = ScriptedClock()
    pipeline = make_pipeline(clock=clock)
    pipeline.open(1000)
    assert not pipeline.feed(FRAMES[0] + UNFINISHED + FRAMES[1], NOW)
    clock.notices = ['end']
    events = pipeline.close()
    assert events[0] == Notice('end') and sequences(events) == [0, 1]
    assert not pipeline.close()


def test_notices_come_before_the_messages_of_their_read():
    """A clock was set before they arrived."""
    clock = ArrivalClock()
    pipeline = make_pipeline(clock=clock)
    assert sequences(pipeline.feed(FRAMES[0], Instant(0, 10 ** 9))) == [0]
    notice, message = pipeline.feed(FRAMES[1], Instant(0, 10 ** 10))
    assert 'was set by +9.0' in notice.text and message.message.sequence == 1


@given(st.integers(0, SIZE - 1), st.booleans())
def test_open_begins_a_stream(cut, closed):
    """Half a frame of the stream before is dropped, whether that was closed or not."""
    clock = ScriptedClock()
    pipeline = make_pipeline(clock=clock)
    pipeline.open(1000)
    pipeline.feed(FRAMES[0] + FRAMES[1][:cut], NOW)
    before = sequences(pipeline.close()) if closed else []
    pipeline.open(500)
    assert not pipeline.feed(FRAMES[1][cut:] if cut else b'', NOW)
    assert not pipeline.feed(FRAMES[2], NOW)
    assert before + sequences(pipeline.close()) == ([0, 2] if closed else [2])
    assert clock.byte_times == [1000, 500]
    assert pipeline.counters.streams == 2


@pytest.mark.parametrize('method', ['feed', 'close'])
def test_a_clock_that_fails_costs_what_waits_in_it(method):
    """The exception is the caller's; what comes later is not affected."""
    clock = ScriptedClock()
    pipeline = make_pipeline(clock=clock)
    pipeline.open(1000)
    pipeline.feed(FRAMES[0], NOW)
    clock.error = ZeroDivisionError()
    with pytest.raises(ZeroDivisionError):
        pipeline.feed(FRAMES[1], NOW) if method == 'feed' else pipeline.close()
    pipeline.feed(FRAMES[2], NOW)
    assert sequences(pipeline.close()) == [2]


def test_counters():
    """They go on over all streams."""
    pipeline = make_pipeline()
    for data in (FRAMES[0] + b'noise', FRAMES[1], b'x' * 300 + FRAMES[2][:5]):
        pipeline.open()
        pipeline.feed(data)
        pipeline.close()
    counters = pipeline.counters
    assert counters.streams == 3
    assert counters.bytes_received == pipeline.received == 2 * SIZE + 310
    assert (counters.framing.frames, counters.framing.skipped_bytes) == (2, 310)
    assert counters.last_bytes == (b'x' * SAMPLE_SIZE + FRAMES[2][:5])[-SAMPLE_SIZE:]


def test_a_hidden_frame_is_found_at_the_end():
    """It was complete; only the half frame before it hid it."""
    half = BahrsCodec().encode(NavigationTime(1, 2, 3), 3)[:9]
    pipeline = make_pipeline()
    assert not pipeline.feed(UNFINISHED + half[5:] + FRAMES[4])
    assert sequences(pipeline.close()) == [4]
