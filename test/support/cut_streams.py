# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of devices through simulated adapters, cut anywhere, and their stamps."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
import random
from typing import Any

from bahrs_driver.clock import Clock, Instant, Stamped
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.units import byte_time_ns, NS_PER_S
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults
from support.emulated import BAUD_RATE, make_device

ADAPTERS = ('none', 0.001, 0.016, 'packets')
RAW, ROS = 5_000 * NS_PER_S, 1_700_000_000 * NS_PER_S
SAMPLES = {'inertial': Inertial, 'navigation': Navigation}
POINTS = (InertialTime, NavigationTime, SyncPulseTime)
Sample = tuple[int, int, int]       # power-on, device time in ns, stamp in ns


@dataclass
class Stream:
    """The reads of a stream (raw time, bytes), and the truth of each sample by its offset."""

    reads: list[tuple[int, bytes]]
    truth: dict[int, tuple[int, int]]       # power-on, device time in ns

    def cut(self, begin: float, end: float) -> 'Stream':
        """Return the part from one byte to another, as shares of the whole or in bytes."""
        length = sum(len(data) for _, data in self.reads)
        first, last = (int(begin), int(end)) if isinstance(begin, int) else sorted(
            (round(begin * length), round(end * length)))
        reads, offset = [], 0
        for time, data in self.reads:
            kept = data[max(0, first - offset):max(0, last - offset)]
            offset += len(data)
            if kept:
                reads.append((time, kept))
        return Stream(reads, {offset - first: true for offset, true in self.truth.items()})

    @property
    def data(self) -> bytes:
        """Return all bytes."""
        return b''.join(data for _, data in self.reads)


def through(emissions: Iterable[tuple[float, bytes]], adapter: str | float,
            seed: int = 1) -> list[tuple[int, bytes]]:
    """Return the reads of (ready in s, bytes) pairs, through a line and an adapter."""
    cable, late, reads, wake = Cable(BAUD_RATE, adapter), random.Random(seed), [], 0.0
    for ready, data in [*emissions, (float('inf'), b'')]:
        while (arrival := cable.next_time) < ready:
            wake = max(wake, arrival) + late.uniform(40e-6, 150e-6)
            reads.append((RAW + round(wake * NS_PER_S), cable.take(wake)))
        cable.send(ready, data)
    return [(time, data) for time, data in reads if data]


def emulated(seconds: float = 6.0, adapter: str | float = 'none',
             restarts: Iterable[float] = (), loss: float = 0.0, damage: float = 0.0,
             seed: int = 1, **behavior: Any) -> Stream:
    """Return the stream of an emulated device."""
    device = make_device(seed=seed, pulse_rate=3.0, drift_ppm=50.0, **behavior)
    faults = Faults(seed, {'drop_frame': loss, 'bit_flip': damage})
    truth: dict[int, tuple[int, int]] = {}
    sent, offset = [], 0
    for power_on, end in enumerate([*restarts, seconds]):
        while device.next_time < end:
            for emission in device.step():
                data = faults.apply(emission.data)
                if emission.name in SAMPLES:
                    time_us: Any = emission.truth['device_time_us']
                    truth[offset] = power_on, time_us * 1000
                sent.append((emission.ready, data))
                offset += len(data)
        device.power_cycle(end)
    return Stream(through(sent, adapter, seed), truth)


@dataclass
class Stamps:
    """The stamps of a clock."""

    items: list[tuple[Any, int, int, int]]       # message, offset, stamp, its read
    clock: Clock
    sent: list[int]                     # offsets of messages that are never dropped


def live(stream: Stream, clock: Clock,
         ros: Callable[[int], int] = lambda raw: raw + ROS) -> Stamps:
    """Return the stamps of a stream that is read live."""
    framer, codec = Framer(BahrsFormat()), BahrsCodec()
    items: list[tuple[Any, int, int, int]] = []
    sent: list[int] = []
    clock.begin(byte_time_ns(BAUD_RATE))
    now = Instant(RAW, ros(RAW))

    def stamp(frames: Iterable[Frame]) -> list[Stamped]:
        messages = [(codec.decode(frame), frame) for frame in frames]
        sent.extend(frame.offset for message, frame in messages
                    if not isinstance(message, POINTS))
        return clock.stamp(messages)

    def take(stamped: Iterable[Stamped]) -> None:
        items.extend((message, frame.offset, stamp, now.ros_ns)
                     for message, frame, stamp in stamped)

    for raw, data in stream.reads:
        found = framer.feed(data)
        now = Instant(raw, ros(raw))
        clock.observe_read(now, framer.received)
        take(stamp(found))
    take(stamp(framer.flush()) + clock.end())
    return Stamps(items, clock, sent)


def converted(stream: Stream, clock: Clock) -> Stamps:
    """Return the stamps of a stream whose recording is converted."""
    smoothing = clock.smoothing()
    assert smoothing
    live(stream, smoothing.first_pass)
    return live(stream, smoothing.second_pass())


def check_promises(stamps: Stamps, truth: dict[int, tuple[int, int]]) -> list[Sample]:
    """Check the promises for any stream; return (epoch, device time, stamp) of the samples."""
    offsets = [offset for _, offset, *_ in stamps.items]
    assert offsets == sorted(offsets)
    assert [offset for message, offset, *_ in stamps.items
            if not isinstance(message, POINTS)] == stamps.sent
    for kind in (*SAMPLES.values(), *POINTS):
        of_kind = [(stamp, read) for message, _, stamp, read in stamps.items
                   if isinstance(message, kind) and getattr(message, 'valid', True)]
        assert all(earlier < later for (earlier, _), (later, _) in zip(of_kind, of_kind[1:])), kind
        assert all(stamp <= read for stamp, read in of_kind), kind
    assert stamps.clock.state().dropped == 0
    samples = [(*truth[offset], stamp) for message, offset, stamp, _ in stamps.items
               if isinstance(message, Inertial)]
    by_time = {(epoch, device): stamp for epoch, device, stamp in samples}
    assert all(by_time.get(truth[offset], stamp) == stamp
               for message, offset, stamp, _ in stamps.items if isinstance(message, Navigation))
    return samples


def worst_period(samples: list[Sample]) -> float:
    """Return the largest relative error of the time between two samples."""
    return max((abs(later - stamp - (after - device)) / (after - device)
                for (epoch, device, stamp), (next_epoch, after, later) in zip(samples, samples[1:])
                if epoch == next_epoch), default=0.0)
