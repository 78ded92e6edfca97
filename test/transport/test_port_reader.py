# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the reader of the port, with a scripted link."""

import contextlib
import threading

from bahrs_driver.clock import ArrivalClock, Instant
from bahrs_driver.errors import LinkError
from bahrs_driver.pipeline import DecodingFault, Notice, Pipeline
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import NavigationTime, SyncPulseTime
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.transport import port_reader
from bahrs_driver.transport.channel import Reading
from bahrs_driver.transport.port_events import (
    BytesRead, Connection, PortOpened, PortUnavailable, PortUsable, Silence, StreamEnded,
)
from bahrs_driver.transport.port_reader import PortReader
from hypothesis import given, strategies as st
import pytest

FRAMES = [BahrsCodec().encode(SyncPulseTime(i, 1000 * i), 3) for i in range(9)]
GONE = LinkError('port is gone', absent=True)
MISSING = LinkError('port does not exist', absent=True)
FORBIDDEN = LinkError('port may not be opened')
BUSY = LinkError('port is in use')


class ScriptedLink:
    """A link with given openings and reads; `done` is set at their end."""

    name = 'port'
    byte_time_ns = 1000

    def __init__(self, openings):
        """Set for each opening an error, or the chunks to read until the port is lost."""
        self._openings = iter(openings)
        self._chunks = iter(())
        self.closed = 0
        self.done = threading.Event()

    def connect(self):
        """Fail or open, as the script demands."""
        opening = next(self._openings, None)
        if opening is None:
            self.done.set()
            raise LinkError('end of the script')
        if isinstance(opening, LinkError):
            raise opening
        self._chunks = iter(opening)

    def read(self):
        """Return the next chunk, always with the same instant."""
        chunk = next(self._chunks, GONE)
        if isinstance(chunk, LinkError):
            raise chunk
        return Reading(chunk, Instant(3_000_000, 10_000_000)) if chunk else None

    def cancel(self):
        """Do nothing: no read waits."""

    def close(self):
        """Count the calls."""
        self.closed += 1


def make_reader(link, clock=None, log=None, **parts):
    """Return a reader whose clock stamps with arrival times."""
    pipeline = Pipeline(parts.get('framer') or Framer(BahrsFormat()),
                        parts.get('decoder') or BahrsCodec(), clock or ArrivalClock())
    return PortReader(link, parts.get('pipeline') or pipeline, FaultLog(log or str, str))


class Diary:
    """Records the events of a reader."""

    def __init__(self):
        """Start empty."""
        self.entries = []
        self.readings = []
        self.connections = []
        self.faults = []
        self.streams = self.ends = 0
        self._handlers = {
            PortOpened: self.opened, PortUsable: self.usable, PortUnavailable: self.unavailable,
            BytesRead: self.read, Silence: self.silence, StreamEnded: self.decoded}

    def record(self, event):
        """Record an event."""
        self._handlers[type(event)](event)

    def opened(self, event):
        """Count a stream."""
        self.streams += 1
        self.connections.append(event.connection)

    def usable(self, event):
        """Record it."""
        assert event.connection == self.connections[-1]
        self.entries.append('opened')

    def unavailable(self, event):
        """Record the reason."""
        self.ends += 1
        if not event.reported:
            self.entries.append(event.reason)

    def read(self, event):
        """Keep the reading."""
        assert event.connection == self.connections[-1]
        self.readings.append(event.reading)
        if event.events is not None:
            self.decoded(event)

    def silence(self, _):
        """Record it."""
        self.entries.append('nothing')

    def decoded(self, event):
        """Record the sequence numbers, and keep the latest messages."""
        self.entries += [item.text for item in event.events if isinstance(item, Notice)]
        self.faults += [item for item in event.events if isinstance(item, DecodingFault)]
        self.last = [item for item in event.events
                     if not isinstance(item, (Notice, DecodingFault))]
        self.entries.append([item.message.sequence for item in self.last])


@contextlib.contextmanager
def running(reader, take):
    """Pass events to a function, in a thread, for the length of a block."""
    def run():
        for event in reader.events():
            take(event)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        reader.stop()
        thread.join()


@pytest.fixture
def play(monkeypatch):
    """Return a function that plays a script to its end and returns diary and reader."""
    monkeypatch.setattr(port_reader, 'FIRST_PAUSE', 0.001)
    monkeypatch.setattr(port_reader, 'LONGEST_PAUSE', 0.002)

    def run(*openings):
        link, diary = ScriptedLink(openings), Diary()
        reader = make_reader(link)
        with running(reader, diary.record):
            assert link.done.wait(60)
        assert link.closed
        return diary, reader

    return run


def test_frames_of_one_read_come_together(play):
    """They are decoded, in order."""
    diary, _ = play([FRAMES[0] + FRAMES[1], b'', FRAMES[2]])
    assert diary.entries[:4] == ['opened', [0, 1], 'nothing', [2]]


def test_bytes_are_yielded_as_they_were_read(play):
    """Each read is an event with its instant, with or without frames."""
    pieces = [FRAMES[0][:5], b'', FRAMES[0][5:] + b'noise']
    diary, _ = play(pieces)
    assert [reading.data for reading in diary.readings] == [pieces[0], pieces[2]]
    assert diary.readings[0].now == Instant(3_000_000, 10_000_000)


def test_stamps_count_back_from_the_end_of_the_read(play):
    """By the bytes from the first of each: two frames of 20 bytes and three bytes of a third."""
    diary, _ = play([FRAMES[0] + FRAMES[1] + FRAMES[2][:3]])
    size = len(FRAMES[0])
    assert [received.stamp_ns for received in diary.last] == [
        10_000_000 - 1000 * (2 * size + 3), 10_000_000 - 1000 * (size + 3)]


def test_a_frame_cut_in_two_is_stamped_from_its_first_byte(play):
    """The second read completes it; all its bytes have passed the line by then."""
    diary, _ = play([FRAMES[0][:7], FRAMES[0][7:]])
    assert diary.last[0].stamp_ns == 10_000_000 - 1000 * len(FRAMES[0])


def test_a_lost_port_is_opened_again(play):
    """Its data is received."""
    diary, reader = play([FRAMES[0]], [FRAMES[1]], [FRAMES[2]])
    assert diary.entries[:8] == [
        'opened', [0], 'port is gone', 'opened', [1], 'port is gone', 'opened', [2]]
    assert reader.counters.times_opened == 3


def test_the_same_reason_is_reported_once(play):
    """However often the port is tried again."""
    diary, _ = play(*[BUSY] * 5, [FRAMES[0]], *[BUSY] * 3)
    assert diary.entries[:5] == ['port is in use', 'opened', [0], 'port is gone', 'port is in use']


def test_a_port_that_is_gone_is_not_reported_as_missing_too(play):
    """Both mean the same; another reason is reported."""
    diary, reader = play([FRAMES[0]], MISSING, MISSING, FORBIDDEN, MISSING, [FRAMES[1]])
    assert diary.entries[:7] == [
        'opened', [0], 'port is gone', 'port may not be opened', 'port does not exist',
        'opened', [1]]


def test_a_port_that_is_lost_at_once_repeatedly_is_reported_once(play):
    """Such as a server that hangs up on a second client; until frames arrive."""
    diary, reader = play(*[[b'Port already in use\r\n']] * 20, [b''], [FRAMES[0]],
                         [b'Port already in use\r\n'], [FRAMES[1]])
    assert [entry for entry in diary.entries if entry != 'nothing'][:8] == [
        'opened', 'port is gone', 'opened', [0], 'port is gone', 'opened', 'port is gone',
        'opened']
    assert reader.counters.times_opened == 24
    assert diary.streams == 24 and diary.ends >= 24


def test_a_port_that_stays_open_is_reported_without_frames(play, monkeypatch):
    """After STABLE_TIME seconds, although it was lost at once before."""
    monkeypatch.setattr(port_reader, 'STABLE_TIME', 0.0)
    diary, _ = play([b'x'], [b'x'])
    assert diary.entries[:4] == ['opened', 'port is gone', 'opened', 'port is gone']


def test_half_a_frame_does_not_spoil_the_next_stream(play):
    """A frame begun before the cable was pulled is dropped."""
    diary, reader = play([FRAMES[0][:11]], [FRAMES[1]])
    assert diary.entries[:4] == ['opened', 'port is gone', 'opened', [1]]


def test_an_intact_frame_behind_half_a_frame_is_not_lost_with_the_cable(play):
    """It is complete; only the half frame before it hid it."""
    half = BahrsCodec().encode(NavigationTime(1, 2, 3), 3)[:9]
    long_half = b'NE\x03\x00\xf3' + half[5:]
    diary, _ = play([long_half + FRAMES[4]])
    assert diary.entries[:3] == ['opened', [4], 'port is gone']


def test_events_name_their_connection(play):
    """By number, and with the time of a byte on the line."""
    diary, _ = play([FRAMES[0]], BUSY, [FRAMES[1]])
    assert diary.connections == [Connection(1, 1000), Connection(2, 1000)]


def test_the_pipeline_works_under_the_lock():
    """No event is yielded while it is held."""
    lock = threading.Lock()
    link, locked = ScriptedLink([FRAMES[:2]]), []

    class Watched(Pipeline):
        def open(self, byte_time_ns=0):     # noqa: A003, as the method of the pipeline
            locked.append(lock.locked())
            super().open(byte_time_ns)

        def feed(self, data, instant):
            locked.append(lock.locked())
            return super().feed(data, instant)

        def close(self):
            locked.append(lock.locked())
            return super().close()

    reader = PortReader(link, Watched(Framer(BahrsFormat()), BahrsCodec()), FaultLog(str, str),
                        lock)
    for event in reader.events():
        assert not lock.locked()
        if isinstance(event, PortUnavailable):
            reader.stop()
    assert locked == [True] * 4


def test_counters(play):
    """Bytes are counted once, by the pipeline; the port is not open."""
    _, reader = play([FRAMES[0], FRAMES[1]], BUSY)
    counters = reader.counters
    assert reader._pipeline.counters.bytes_received == len(FRAMES[0]) + len(FRAMES[1])
    assert counters.open_since is None
    assert counters.last_data is not None


class Failing:
    """A part whose method fails at one call and works at all others."""

    def __init__(self, part, method, turn, error):
        """Raise an error at the call of the method with this number, from 0."""
        self._part, self._method, self._turn, self._error = part, method, turn, error
        self.failed = False

    def __getattr__(self, name):
        """Return an attribute of the part."""
        found = getattr(self._part, name)
        if name != self._method:
            return found

        def method(*arguments):
            self._turn -= 1
            if self._turn == -1:
                self.failed = True
                raise self._error
            return found(*arguments)
        return method


METHODS = {
    'link': ('connect', 'read', 'cancel', 'close'),
    'framer': ('feed', 'flush'),
    'decoder': ('decode',),
    'clock': ('begin', 'observe_read', 'stamp', 'end', 'take_notices'),
    'pipeline': ('open', 'feed', 'close')}
FAULTS = (ValueError('bad'), KeyError(3), OSError(5, 'I/O'), RuntimeError(), TypeError('x'),
          UnicodeDecodeError('utf-8', b'x', 0, 1, 'bad'), MemoryError(), RecursionError(),
          AssertionError(), ZeroDivisionError(), StopIteration(), OverflowError('\x1b[2J'))


@pytest.mark.slow
@given(st.sampled_from([(part, method) for part, methods in METHODS.items()
                        for method in methods]),
       st.integers(0, 2), st.sampled_from(FAULTS))
def test_no_fault_anywhere_ends_the_stream(where, turn, error):
    """It costs the data it happens to; later frames and openings are not affected."""
    part, method = where
    link = ScriptedLink([FRAMES[:3] + [b''] * 3, FRAMES[3:6], FRAMES[6:8], FRAMES[8:]])
    diary, log = Diary(), []
    parts = {'link': link, 'framer': Framer(BahrsFormat()), 'decoder': BahrsCodec(),
             'clock': ArrivalClock()}
    parts['pipeline'] = Pipeline(parts['framer'], parts['decoder'], parts['clock'])
    parts[part] = failing = Failing(parts[part], method, turn, error)
    if part != 'pipeline':
        del parts['pipeline']
    reader = make_reader(log=log.append, **parts)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(port_reader, 'FIRST_PAUSE', 0.0)
        patch.setattr(port_reader, 'LONGEST_PAUSE', 0.0)
        with running(reader, diary.record):
            assert link.done.wait(60)
    batches = [entry for entry in diary.entries if isinstance(entry, list)]
    assert batches[-1] == [8]
    assert sum(map(len, batches)) >= len(FRAMES) - 4
    assert len(log) + len(diary.faults) == failing.failed


def test_a_frame_that_cannot_be_decoded_costs_no_other(play, monkeypatch):
    """Not even those of the same read."""
    decode = BahrsCodec.decode

    def choosy(self, frame, now):
        message = decode(self, frame, now)
        if message.sequence == 1:
            raise KeyError('unknown')
        return message

    monkeypatch.setattr(BahrsCodec, 'decode', choosy)
    diary, _ = play([FRAMES[0] + FRAMES[1] + FRAMES[2]])
    assert diary.entries[:2] == ['opened', [0, 2]]
    assert [fault.frame.data for fault in diary.faults] == [FRAMES[1]]


def test_pauses_grow_and_are_bounded(monkeypatch):
    """They double from FIRST_PAUSE to LONGEST_PAUSE."""
    pauses = []
    link, diary = ScriptedLink([BUSY] * 7), Diary()
    reader = make_reader(link)

    class Watch(threading.Event):
        def wait(self, timeout=None):
            pauses.append(timeout)
            return super().wait(0)

    monkeypatch.setattr(reader, '_stopping', Watch())
    with running(reader, diary.record):
        assert link.done.wait(60)
    assert pauses[:7] == pytest.approx([0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0])


def test_stopping_does_not_wait_for_the_pause(monkeypatch):
    """A missing port does not delay the end."""
    monkeypatch.setattr(port_reader, 'FIRST_PAUSE', 3600)
    monkeypatch.setattr(port_reader, 'LONGEST_PAUSE', 3600)
    reader = make_reader(ScriptedLink([BUSY] * 2))
    thread = threading.Thread(target=lambda: list(reader.events()), daemon=True)
    thread.start()
    reader.stop()
    thread.join(60)
    assert not thread.is_alive()
