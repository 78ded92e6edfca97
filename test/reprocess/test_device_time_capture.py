# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of streams without read times, cut anywhere: every sample has its device time."""

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.clock import Instant
from bahrs_driver.devices.bahrs.recording_format import make_recording_format
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    SoftwareVersion,
    SyncPulseTime,
)
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.reprocess.device_time_capture import DeviceTimeCapture
from bahrs_driver.reprocess.sample_times import RESTART_DURATION
from bahrs_driver.virtual_serial.faults import Faults
from hypothesis import example, given, settings, strategies as st
import pytest
from support.emulated import make_device
from support.shared_files import shared_file

S = 1_000_000_000
PERIOD = ROLES.sample_period
SAMPLES = (Inertial, Navigation)


class Bytes(Capture):
    """A capture of bytes, in chunks of a size."""

    def __init__(self, data, tmp_path='.', size=1000):
        super().__init__(tmp_path, len(data))
        self._data, self._piece = data, size

    def chunks(self):
        """Return the chunks."""
        return (Chunk(self._data[place:place + self._piece])
                for place in range(0, len(self._data), self._piece))


def stamped(data, start=None, size=1000, label='auto', latency=0):
    """Return all stamped messages of a stream."""
    def make_pipeline(clock=None):
        return Pipeline(Framer(BahrsFormat()), BahrsCodec(), clock)

    recording_format = make_recording_format(BahrsSettings(), 'BAHRS')
    timed = DeviceTimeCapture(
        Bytes(data, size=size), recording_format, label, start, lambda what: None)
    pipeline, found, chunks = make_pipeline(timed.clock(latency)), [], []
    for chunk in timed.chunks():
        chunks.append(chunk)
        found += pipeline.feed(chunk.data, Instant(chunk.ros_ns, chunk.ros_ns))
    found += pipeline.close()
    assert b''.join(chunk.data for chunk in chunks) == data
    assert [chunk.ros_ns for chunk in chunks] == sorted(chunk.ros_ns for chunk in chunks)
    return found


def frames_of(data):
    """Return all intact frames of a stream."""
    framer = Framer(BahrsFormat())
    return framer.feed(data) + framer.flush()


def check(found, data, truth):
    """Check stamps. truth has (epoch, device time in ns) by the offset of each sample."""
    frames = frames_of(data)
    assert [item.frame.offset for item in found] == [frame.offset for frame in frames]
    for kind in (*SAMPLES, InertialTime, NavigationTime, SyncPulseTime):
        stamps = [item.stamp_ns for item in found if isinstance(item.message, kind)
                  and getattr(item.message, 'valid', True)]
        assert all(earlier < later for earlier, later in zip(stamps, stamps[1:]))
        assert all(stamp > 0 for stamp in stamps)
    check_periods([(*truth[item.frame.offset], item.stamp_ns) for item in found
                   if isinstance(item.message, SAMPLES)],
                  [type(item.message) for item in found if isinstance(item.message, SAMPLES)])


def check_periods(samples, kinds):
    """Check the time between samples, each given as its epoch, device time and stamp."""
    unknown = False
    for (epoch, device, stamp), (next_epoch, next_device, next_stamp), next_kind in zip(
            samples, samples[1:], kinds[1:]):
        # If the version message was lost, only an inertial message shows a restart.
        unknown = unknown or (epoch != next_epoch and next_kind is Navigation)
        if not unknown and epoch == next_epoch:
            assert abs(next_stamp - stamp - (next_device - device)) < 1000
        elif not unknown:
            assert next_stamp > stamp
        assert next_stamp >= stamp
        unknown = unknown and next_kind is Navigation


@pytest.fixture(scope='module')
def recording():
    """Return the bytes of the recording, and (epoch, device time) of each sample by offset."""
    data = shared_file('data/bahrs_recording_v2.bin').read_bytes()
    codec, truth, count, second = BahrsCodec(), {}, -1, None
    for frame in frames_of(data):
        message = codec.decode(frame)
        count += isinstance(message, Inertial)
        if isinstance(message, InertialTime) and count == 20:
            second = message.device_time_us * 1000
    count = -1
    for frame in frames_of(data):
        message = codec.decode(frame)
        count += isinstance(message, Inertial)
        if isinstance(message, SAMPLES):
            truth[frame.offset] = int(count >= 20), second + (count - 20) * PERIOD
    return data, truth


@pytest.mark.slow
@settings(max_examples=80)
@given(begin=st.integers(0, 60_000), length=st.integers(0, 12_000), size=st.integers(1, 20_000),
       start=st.sampled_from([None, 0, 1_700_000_000 * S]))
@example(0, 30_000, 1000, None)
@example(1000, 25, 1000, None)
def test_the_recording_cut_at_any_byte(recording, begin, length, size, start):
    """Every sample has its device time, and messages before the first one have a stamp."""
    data, truth = recording
    cut = data[begin:begin + length]
    found = stamped(cut, start, size)
    check(found, cut, {offset - begin: true for offset, true in truth.items()})
    if start is None:
        for item in found:
            if isinstance(item.message, InertialTime):
                assert item.stamp_ns == item.message.device_time_us * 1000
        known = any(isinstance(item.message, (InertialTime, NavigationTime)) for item in found)
        for item in found if known and begin > 1000 else []:
            if isinstance(item.message, SAMPLES):
                assert item.stamp_ns == truth[item.frame.offset + begin][1]


@pytest.mark.slow
def test_the_whole_recording(recording):
    """Every sample has its device time."""
    data, truth = recording
    check(stamped(data), data, truth)


def emulated(seconds, restarts=(), loss=0.0, damage=0.0, seed=1, forget=(), **behavior):
    """Return the bytes of an emulated device, and (epoch, device time) of its samples."""
    device = make_device(seed=seed, pulse_rate=3.0, drift_ppm=50.0, **behavior)
    faults = Faults(seed, {'drop_frame': loss, 'bit_flip': damage})
    data, truth, ends = b'', {}, [*restarts, seconds]
    for epoch, end in enumerate(ends):
        while device.next_time < end:
            for emission in device.step():
                frame = faults.apply(emission.data)
                if emission.name in forget:
                    continue
                if emission.name in ('inertial', 'navigation'):
                    truth[len(data)] = epoch, emission.truth['device_time_us'] * 1000
                data += frame
        device.power_cycle(end)
    return data, truth


@pytest.mark.slow
@settings(max_examples=60)
@given(version=st.integers(1, 3), time_label=st.sampled_from(['next', 'same']),
       loss=st.sampled_from([0.0, 0.01, 0.1]), damage=st.sampled_from([0.0, 0.0005]),
       restarts=st.lists(st.floats(0.7, 4.0), max_size=2).map(sorted), seed=st.integers(0, 999),
       begin=st.floats(0, 1), end=st.floats(0, 1))
def test_emulated_streams_cut_at_any_byte(begin, end, **what):
    """Streams of any protocol version, with losses and restarts, have correct periods."""
    data, truth = emulated(5.0, **what)
    begin, end = sorted((round(begin * len(data)), round(end * len(data))))
    cut = data[begin:end]
    check(stamped(cut), cut, {offset - begin: true for offset, true in truth.items()})


def test_a_restart_takes_a_second():
    """The last sample before it and the first one after it are one second apart."""
    data, truth = emulated(6.0, restarts=(3.0,))
    samples = [(truth[item.frame.offset][0], item.stamp_ns) for item in stamped(data)
               if isinstance(item.message, Inertial)]
    last = max(stamp for epoch, stamp in samples if epoch == 0)
    assert min(stamp for epoch, stamp in samples if epoch == 1) == last + RESTART_DURATION


@pytest.mark.parametrize('forget', [
    ('inertial_time', 'navigation_time'), ('inertial',), ('navigation',), ('inertial_time',),
    ('navigation_time',), ('inertial_time', 'inertial'),
    ('inertial_time', 'navigation_time', 'inertial')])
def test_streams_without_some_types_of_messages(forget):
    """Counters alone give the period, and one type of time message gives device time."""
    data, truth = emulated(4.0, forget=forget)
    found = stamped(data)
    check(found, data, truth)
    if not {'inertial_time', 'navigation_time'} <= set(forget):
        assert all(item.stamp_ns == truth[item.frame.offset][1] for item in found
                   if isinstance(item.message, SAMPLES))
    else:
        assert min(item.stamp_ns for item in found) < 10


@pytest.mark.parametrize('begin', [5, 100, 1000])
def test_a_pause_in_which_the_counter_wraps(begin):
    """Samples after the pause have their device time."""
    codec = BahrsCodec()
    data, truth = emulated(8.0)
    ends = [frame.end for frame in frames_of(data) if type(codec.decode(frame)) is Navigation]
    cut = data[:ends[begin % 300]] + data[ends[begin % 300 + 2 * 163]:]
    found = stamped(cut)
    errors = [item.stamp_ns - true for item, true in zip(
        [item for item in found if isinstance(item.message, Inertial)],
        [truth[offset][1] for offset in sorted(truth) if not ends[begin % 300] <= offset
         < ends[begin % 300 + 2 * 163]][::2])]
    assert found and errors


def test_one_wrong_time_message_is_ignored():
    """Stamps do not change."""
    data, truth = emulated(4.0)
    codec = BahrsCodec()
    right = [item.stamp_ns for item in stamped(data) if isinstance(item.message, SAMPLES)]
    places = [frame for frame in frames_of(data) if type(codec.decode(frame)) is InertialTime]
    for index, time in ((5, 10 ** 12), (9, 7), (14, 2 ** 63)):
        frame = places[index]
        message = codec.decode(frame)
        wrong = codec.encode(InertialTime(message.sequence, message.reference_sequence, time), 3)
        damaged = data[:frame.offset] + wrong + data[frame.end:]
        assert [item.stamp_ns for item in stamped(damaged)
                if isinstance(item.message, SAMPLES)] == right


@pytest.mark.parametrize('clock_start', [2 ** 40, 2 ** 52, 2 ** 62])
def test_a_device_time_that_ros_cannot_hold(clock_start):
    """Stamps begin in 1970 if device time is after 2038."""
    data, truth = emulated(3.0)
    codec = BahrsCodec()
    moved = b''
    for frame in frames_of(data):
        message = codec.decode(frame)
        if isinstance(message, (InertialTime, NavigationTime)) and message.valid:
            message = type(message)(message.sequence, message.reference_sequence,
                                    message.device_time_us + clock_start)
        moved += codec.encode(message, 3)
    stamps = [item.stamp_ns for item in stamped(moved)]
    assert 0 <= min(stamps) and max(stamps) < 2 ** 31 * S


def test_a_forced_label_and_a_fixed_latency():
    """They have the same effect as in the live clock."""
    data, truth = emulated(3.0, time_label='same')
    plain = [item.stamp_ns for item in stamped(data) if isinstance(item.message, Inertial)]
    forced = [item.stamp_ns for item in stamped(data, label='next', latency=1000)
              if isinstance(item.message, Inertial)]
    assert {one - other for one, other in zip(plain, forced)} == {1000 - PERIOD}


def test_a_stream_without_samples():
    """A version message has a stamp, although no time is known."""
    data = BahrsCodec().encode(SoftwareVersion('ABC', 1, 2), 3)
    (found,) = stamped(data)
    assert found.stamp_ns >= 0 and stamped(b'') == []
