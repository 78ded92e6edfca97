# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of converting captures of emulated devices."""

import functools
import math
from pathlib import Path

from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.convert.titan_m.converter import TOPICS as TITAN_TOPICS
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import InertialTime, NvmPage
from bahrs_driver.protocol.bahrs.nvm_session import PAGE_SIZE
from bahrs_driver.protocol.titan_m.messages import StateRequest
from bahrs_driver.reprocess import ordered_writer
from bahrs_driver.reprocess.conversion import Conversion
from bahrs_driver.reprocess.ordered_writer import OrderedWriter
import pytest
from support.conversions import converted, flight, Kept, ORIGIN, Pieces, S, stamps
from support.emulated import decoded, emissions, make_device
from support.polled import PolledDevice
from support.settings_examples import settings_of


def test_all_topics_of_a_flight(tmp_path):
    """Stamps are accurate from the first one on; all topics and bytes are in order."""
    chunks, truth = flight()
    kept, outcome = converted(Pieces(chunks, tmp_path))
    errors = [stamp - true for stamp, true in zip(stamps(kept), truth)]
    assert len(errors) > 1400
    assert max(errors) - min(errors) < 60_000 and abs(min(errors)) < 100_000
    assert set(kept.messages) == {*TOPICS, 'raw', 'nvm/page', '/diagnostics'}
    assert kept.latched == {'integrity'}
    assert all(kept.messages[topic] for topic in TOPICS if topic != 'sync_pulse')
    assert kept.times == sorted(kept.times)
    assert b''.join(message.data.tobytes() for _, message in kept.messages['raw']) == b''.join(
        chunk.data for chunk in chunks)
    assert [time for time, _ in kept.messages['imu/data_raw']] == stamps(kept)
    assert outcome.messages == len(kept.times) and outcome.skipped_bytes < 28


def test_pages_of_the_memory(tmp_path):
    """The page that a service read during the flight is on its topic."""
    chunks, _ = flight(2.0)
    page = bytes(range(PAGE_SIZE))
    *before, last = chunks
    later = last._replace(data=BahrsCodec().encode(NvmPage(3, page), 3, 'crc32'),
                          ros_ns=last.ros_ns + S, raw_ns=last.raw_ns + S)
    kept, _ = converted(Pieces([*before, last, later], tmp_path))
    ((time, message),) = kept.messages['nvm/page']
    assert message.data.tobytes() == page and time == later.ros_ns
    assert message.layout.dim[0].label == 'page=3'


def test_diagnostics_report_damage_and_silence(tmp_path):
    """Reports have the times of the flight; tasks recover."""
    chunks, _ = flight(14.0)
    damaged = [chunk._replace(data=chunk.data[:-3] + b'xyz')
               if 4 * S < chunk.ros_ns - ORIGIN < 4.5 * S else chunk
               for chunk in chunks if not 8 * S < chunk.ros_ns - ORIGIN < 10 * S]
    kept, _ = converted(Pieces(damaged, tmp_path))
    reports = [(time - ORIGIN, {status.name: status for status in array.status})
               for time, array in kept.messages['/diagnostics']]

    def reported(task, begin, end):
        return {(status.level[0], status.message) for time, statuses in reports
                if begin * S <= time < end * S
                for status in [statuses[f'bahrs_driver: {task}']]}

    assert reported('Framing', 2.5, 4) == {(0, 'All frames intact')}
    assert any(level and 'damaged' in text for level, text in reported('Framing', 4, 5.5))
    assert any(level == 3 for level, _ in reported('Rates', 9, 10))
    assert (0, 'All messages at their rates') in reported('Rates', 12, 14.1)
    assert {name for _, statuses in reports for name in statuses} == {
        f'bahrs_driver: {task}' for task in (
            'Framing', 'Time', 'Rates', 'Integrity', 'Device', 'Publishing')}


def test_stamps_if_the_clock_is_set(tmp_path):
    """Stamps are in the old time or in the new, and none is between."""
    chunks, truth = flight(4.0)
    chunks = [chunk._replace(ros_ns=chunk.ros_ns + 3600 * S) if index >= 100 else chunk
              for index, chunk in enumerate(chunks)]
    kept, _ = converted(Pieces(chunks, tmp_path))
    errors = {round((stamp - true) / S) for stamp, true in zip(stamps(kept), truth)}
    assert errors == {0, 3600}


def set_clock(chunks, sets, steady=True):
    """Return chunks of a host whose clock is set at some chunks, each time by some seconds."""
    return [chunk._replace(
        ros_ns=chunk.ros_ns + S * sum(size for begin, size in sets if index >= begin),
        raw_ns=chunk.raw_ns if steady else None) for index, chunk in enumerate(chunks)]


@functools.cache
def long_flight():
    """Return a flight that is longer than messages are held, and its conversion."""
    chunks, _ = flight(12.0)
    kept, outcome = converted(Pieces(chunks, Path('flight')))
    assert outcome.clock_steps == []
    return chunks, kept


@pytest.mark.parametrize('sets', [
    [(300, -3600)], [(1, -3600)], [(300, 3600)], [(100, -3600), (200, 7200), (600, -1)],
    [(700, -86400 * 365)], [(index, -1) for index in range(50, 700)]])
def test_log_times_if_the_clock_is_set(tmp_path, sets):
    """Log times are those of a clock that is not set, and the steps are reported."""
    chunks, plain = long_flight()
    kept, outcome = converted(Pieces(set_clock(chunks, sets), tmp_path))
    assert "the host's clock was set by " in outcome.clock_steps[0]
    assert kept.times == sorted(kept.times)
    for topic in plain.messages:
        if topic != '/diagnostics':             # which reports the steps, too
            near = [abs(now - before) for (now, _), (before, _) in zip(
                kept.messages[topic], plain.messages[topic], strict=True)]
            assert max(near, default=0) < 100_000, topic
    reports = [time for time, _ in kept.messages['/diagnostics']]
    assert max(later - sooner for sooner, later in zip(reports, reports[1:])) <= 1.1 * S


@pytest.mark.parametrize('begin', [1, 300, 700])
def test_log_times_without_a_steady_clock(tmp_path, begin):
    """Messages keep their order, and their spacing except at the step."""
    chunks, _ = long_flight()
    kept, outcome = converted(Pieces(set_clock(chunks, [(begin, -3600)], False), tmp_path))
    times = [time for time, _ in kept.messages['imu/data_raw']]
    assert kept.times == sorted(kept.times) and len(outcome.clock_steps) == 1
    spacing = sorted(later - sooner for sooner, later in zip(times, times[1:]))
    assert 4_000_000 < spacing[len(spacing) // 100] and spacing[-100] < 6_000_000
    assert 11 * S < times[-1] - times[0] < 12.1 * S


def test_a_lost_connection(tmp_path):
    """The integrity is not_heard at that time, as in the node; the unfinished frame is skipped."""
    chunks, truth = flight(4.0)
    cut = [chunk if index != 100 else chunk._replace(data=chunk.data[:5])
           for index, chunk in enumerate(chunks[:101])]
    again = [chunk._replace(connection_id=2) for chunk in chunks[110:]]
    kept, outcome = converted(Pieces(cut + again, tmp_path))
    states = [message.status[0].message for _, message in kept.messages['integrity']]
    assert states.count('not_heard') == 1 and states[-1] != 'not_heard'
    assert outcome.skipped_bytes > 0


@pytest.mark.slow
def test_bytes_without_times(tmp_path):
    """Stamps are device time, or begin at the given start; they continue after a restart."""
    device = make_device()
    data = b''.join(item.data for item in emissions(device, 5.0))
    device.power_cycle(5.0)
    data += b''.join(item.data for item in emissions(device, 10.0))
    file = tmp_path / 'flight.bin'
    file.write_bytes(data)
    kept, outcome = converted(open_capture(file))
    plain = stamps(kept)
    assert 'raw' not in kept.messages
    times = [message.device_time_us * 1000 for message in decoded(data)
             if isinstance(message, InertialTime)]
    first = [stamp for stamp in plain if stamp <= 5 * S]
    assert set(times[:10]) <= set(first)
    assert all(abs(later - earlier - 5_000_000) < 1000
               for earlier, later in zip(first, first[1:]))
    assert plain == sorted(set(plain)) and 5 * S < plain[-1] < 15 * S
    started, _ = converted(open_capture(file), ORIGIN)
    assert [stamp - plain[0] for stamp in plain] == [
        stamp - stamps(started)[0] for stamp in stamps(started)]
    assert ORIGIN in stamps(started)


def test_bytes_without_any_time_message(tmp_path):
    """The nominal period gives the stamps."""
    codec = BahrsCodec()
    frames = [codec.encode(message, 3) for message in decoded(b''.join(
        item.data for item in emissions(make_device(), 2.0)))
        if not hasattr(message, 'device_time_us')]
    file = tmp_path / 'flight.bin'
    file.write_bytes(b''.join(frames))
    kept, _ = converted(open_capture(file))
    assert len(kept.messages['imu/data_raw']) > 200
    assert all(math.isfinite(time) for time in kept.times)


def test_arrival_stamps(tmp_path):
    """With time.source:=arrival, stamps are not smoothed."""
    chunks, truth = flight(3.0)
    kept, _ = converted(Pieces(chunks, tmp_path), **{'time.source': 'arrival'})
    late = [stamp - true for stamp, true in zip(stamps(kept), truth)]
    assert len(late) > 400 and max(late) - min(late) > 5_000_000


def test_odometry_of_a_flight_without_gps(tmp_path):
    """Answers alone show which messages were polled."""
    polled = PolledDevice(rates={StateRequest: 20.0})
    polled.run(4.0)
    chunks = [Chunk(data, ORIGIN + round(time * S), round(time * S))
              for time, data in polled.chunks]
    kept, _ = converted(Pieces(chunks, tmp_path), sensor='titan_m')
    assert len(kept.messages['velocity']) > 70 and len(kept.messages['odometry']) > 30


def test_polled_device(tmp_path):
    """The stamp of an answer is its arrival minus its transmission time; requests are unknown."""
    polled = PolledDevice()
    polled.run(4.0)
    chunks = [Chunk(data, ORIGIN + round(time * S), round(time * S))
              for time, data in polled.chunks]
    kept, outcome = converted(Pieces(chunks, tmp_path), sensor='titan_m')
    assert set(kept.messages) == {*TITAN_TOPICS, 'raw', '/diagnostics'}
    assert all(kept.messages.values())
    assert outcome.frames == len(polled.received) and outcome.skipped_bytes == 0
    truth = [ORIGIN + round(sent.emission.time * S) for sent in polled.sent
             if sent.emission.name == 'sensors']
    errors = [stamp - true for stamp, true in zip(stamps(kept), truth)]
    assert len(errors) > 190 and 0 < min(errors) and max(errors) < 1_000_000


def test_number_of_held_messages_is_limited(tmp_path, monkeypatch):
    """This holds even if all reads have the same time; no message is lost."""
    write_until, held = OrderedWriter.write_until, []

    def recorded(output, now):
        write_until(output, now)
        held.append(len(output._held))

    monkeypatch.setattr(ordered_writer, 'MOST_HELD', 200)
    monkeypatch.setattr(ordered_writer, 'WRITTEN_AT_ONCE', 100)
    monkeypatch.setattr(OrderedWriter, 'write_until', recorded)
    chunks = [chunk._replace(ros_ns=ORIGIN, raw_ns=5 * S) for chunk in flight(4.0)[0]]
    conversion = Conversion(Pieces(chunks, tmp_path), settings_of(), DEVICES['bahrs'])
    kept = Kept()
    conversion.run(kept, lambda what: None)
    assert 250 < max(held) < 300
    assert len(kept.messages['raw']) == len(chunks)
    assert len(kept.times) > 1500 and kept.times == sorted(kept.times)
