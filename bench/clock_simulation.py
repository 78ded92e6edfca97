# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Simulate a device, a line, an adapter and a busy host, with known truth.

The simulation makes messages and the instants of their reads, not bytes, so ten minutes take a few
seconds. Each stage is a generator over the previous one. True time is the host's raw time, in ns.
"""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
import math
import random
from typing import Any, NamedTuple

from bahrs_driver.clock import Instant
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import byte_time_ns, NS_PER_S

BYTE_TIME = byte_time_ns(115200)
PERIOD_US = 5000
ORIGIN = 5_000 * NS_PER_S       # the host's raw time when the device is switched on
ROS_OFFSET = 1_700_000_000 * NS_PER_S
FIFO = 8                        # bytes that a plain port buffers
BURST, IDLE = 8 * 62, 16_000_000        # bytes, and ns after which fewer are delivered
_SIZES = {Inertial: 28, Navigation: 28, Accuracy: 28, InertialTime: 20, NavigationTime: 20,
          SyncPulseTime: 20}
_INERTIAL = [Inertial(i, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), ()) for i in range(256)]
_NAVIGATION = [Navigation(i, 0.0, 0.0, 0.0, 0.0, 0.0, ()) for i in range(256)]
_NO_FAULTS: dict[str, Any] = dict.fromkeys(
    ('bad_counters', 'bad_times', 'duplicates', 'swaps'), 0.0)
_ACCURACY = Accuracy(0, None, None, None, 0)


def plain_ros(raw: int) -> int:
    """Return the ROS time of a host whose clock is not set."""
    return raw + ROS_OFFSET


@dataclass(frozen=True)
class Case:
    """A case to simulate. Shares are those of the frames of a type, times are in seconds."""

    seconds: float = 600.0
    adapter: str | float = 0.016        # latency timer, 'packets', or 'plain'
    drift_ppm: float = 35.0
    wander_ppm: float = 0.02            # per root second
    temperature_ppm: float = 0.0        # amplitude of a swing of ten minutes
    label: int = 1                      # 1: time messages name the next sample, 0: the same
    loss: float = 0.0                   # damaged frames
    bad_counters: float = 0.0
    bad_times: float = 0.0
    duplicates: float = 0.0             # of samples and of time messages
    swaps: float = 0.0                  # time messages that come some samples late
    faults_until: float = math.inf
    first_time_message: float = 0.0
    pause_before: int = 0               # sample before which the device pauses
    pause: float = 0.0
    restarts: tuple[float, ...] = ()
    overload: tuple[float, float] = (0.0, 0.0)
    pulses: tuple[float, float] = (0.0, 0.0)            # from and to
    delay: float = 0.0                  # from a sample to its first byte
    ros: Callable[[int], int] = plain_ros


class Sent(NamedTuple):
    """A message, the time at which it was ready to be sent, and the time of its sample."""

    ready: int
    message: Any
    truth: int
    device: int

    @property
    def size(self) -> int:
        """Bytes on the line."""
        return _SIZES[type(self.message)]


class OnLine(NamedTuple):
    """A message on the line: its offset in the stream, and the time at which it began to leave."""

    offset: int
    start: int
    sent: Sent

    @property
    def size(self) -> int:
        """Bytes on the line."""
        return self.sent.size


class Read(NamedTuple):
    """A read: its instant, the bytes received by then, and the messages that it completed."""

    now: Instant
    received: int
    messages: list[tuple[Any, Frame]]


class Simulation:
    """The reads of a case, and the truth of each message by the offset of its frame."""

    def __init__(self, case: Case, seed: int) -> None:
        """Simulate a case; the seed determines all random numbers."""
        self.case = case
        self.truths: dict[int, int] = {}            # raw time
        self.device_times: dict[int, int] = {}      # ns
        self._seed = seed

    def reads(self, all_sent: Iterator[Sent] | None = None) -> Iterator[Read]:
        """Yield the reads of the given messages, or of those of the simulated device."""
        undelivered: deque[OnLine] = deque()
        line = _tee(_line(all_sent or _device(self.case, self._seed)), undelivered)
        source = random.Random(f'loss {self._seed}')
        faulty = ORIGIN + min(self.case.faults_until, 1e9) * NS_PER_S
        for time, received in _host(self.case, self._seed, _deliveries(self.case.adapter, line)):
            messages = []
            while undelivered and undelivered[0].offset + undelivered[0].size <= received:
                item = undelivered.popleft()
                if source.random() >= self.case.loss or time > faulty:
                    self.truths[item.offset] = item.sent.truth
                    self.device_times[item.offset] = item.sent.device
                    frame = Frame(item.offset, bytes(item.size), 'word')
                    messages.append((item.sent.message, frame))
            yield Read(Instant(time, self.case.ros(time)), received, messages)


def _device(case: Case, seed: int) -> Iterator[Sent]:
    """Yield the messages of the device, with true times."""
    begin = 0.0
    for index, end in enumerate((*case.restarts, case.seconds)):
        yield from _power_on(case, random.Random(f'device {seed} {index}'), begin, end)
        begin = end + 0.3


def _power_on(case: Case, source: random.Random, begin: float, end: float) -> Iterator[Sent]:
    time, device, count, pulse, walk = begin + 0.6, 600_000, 0, 0, 0.0
    late: deque[Sent] = deque()
    while True:
        if count and count == case.pause_before:
            time, device = time + case.pause, device + round(case.pause * 1e6)
        if time >= end:
            return
        truth = ORIGIN + round(time * NS_PER_S)
        ready = truth + round(case.delay * NS_PER_S)
        rate = 1e-6 * (case.drift_ppm + walk
                       + case.temperature_ppm * math.sin(2 * math.pi * time / 600))
        faults = case if time < case.faults_until else replace(case, **_NO_FAULTS)
        for message in _sample(faults, source, count, device, time):
            late.append(Sent(ready, message, truth, device * 1000))
            if not (isinstance(message, (InertialTime, NavigationTime))
                    and source.random() < faults.swaps):
                yield late.pop()
        if late and count % 7 == 0:
            yield late.popleft()._replace(ready=ready)
        since = case.ros(truth) % NS_PER_S          # pulses come at whole seconds of ROS time
        if since < PERIOD_US * 1000 and case.pulses[0] <= time < case.pulses[1]:
            at = device - round(since * 1e-3 * (1 + rate))
            yield Sent(ready, SyncPulseTime(pulse % 256, at), truth - since, at * 1000)
            pulse += 1
        count, device = count + 1, device + PERIOD_US
        walk += source.gauss(0.0, case.wander_ppm * math.sqrt(PERIOD_US * 1e-6))
        time += PERIOD_US * 1e-6 / (1 + rate)


def _sample(case: Case, source: random.Random, count: int, device: int,
            time: float) -> Iterator[Any]:
    bad = source.random() < case.bad_counters
    inertial = _INERTIAL[source.randrange(256) if bad else count % 256]
    yield inertial
    if source.random() < case.duplicates:
        yield inertial
    with_time = count % 20 == 0 and time >= case.first_time_message
    if with_time:
        yield from _time(case, source, InertialTime, count, device)
    if count % 2 == 0:
        yield _NAVIGATION[count // 2 % 256]
    if with_time:
        yield _ACCURACY
        if count >= 16:
            yield from _time(case, source, NavigationTime, count // 2, device)
        else:
            yield NavigationTime(0, 0, 0)


def _time(case: Case, source: random.Random, kind: type[Any], count: int,
          device: int) -> Iterator[Any]:
    bad = source.random() < case.bad_times
    message = kind(count // 20 % 256, (count + case.label) % 256,
                   source.randrange(2 ** 40) if bad else device)
    yield message
    if source.random() < case.duplicates:
        yield message


def _line(all_sent: Iterator[Sent]) -> Iterator[OnLine]:
    offset = free = 0
    for sent in all_sent:
        item = OnLine(offset, max(free, sent.ready), sent)
        offset, free = offset + item.size, item.start + item.size * BYTE_TIME
        yield item


def _tee(line: Iterator[OnLine], copy: deque[OnLine]) -> Iterator[OnLine]:
    """Yield the messages on the line, and append each to a copy."""
    for item in line:
        copy.append(item)
        yield item


def _deliveries(adapter: str | float, line: Iterator[OnLine]) -> Iterator[tuple[int, int]]:
    """Yield the times at which the adapter delivers bytes, and the bytes by then."""
    if adapter == 'plain':
        for item in line:
            for count in range(FIFO, item.size + FIFO, FIFO):
                count = min(count, item.size)
                yield item.start + count * BYTE_TIME, item.offset + count
    elif adapter == 'packets':
        yield from _bursts(line)
    else:
        yield from _timed(round(float(adapter) * NS_PER_S), line)


def _timed(timer: int, line: Iterator[OnLine]) -> Iterator[tuple[int, int]]:
    due = last = 0
    for item in line:
        due = due or item.start // timer * timer
        end = item.start + item.size * BYTE_TIME
        while due <= end:
            received = item.offset + max(0, due - item.start) // BYTE_TIME
            if received > last:
                yield due, received
                last = received
            due += timer


def _bursts(line: Iterator[OnLine]) -> Iterator[tuple[int, int]]:
    next_full, end, offset = BURST, 0, 0
    for item in line:
        if end and item.start > end + IDLE and offset > next_full - BURST:
            yield end + IDLE, offset
            next_full = offset + BURST
        end, offset = item.start + item.size * BYTE_TIME, item.offset + item.size
        if offset >= next_full:
            yield item.start + (next_full - item.offset) * BYTE_TIME, next_full
            next_full += BURST


def _host(case: Case, seed: int,
          deliveries: Iterator[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Yield the times of the reads, a little after delivery, and the bytes by then."""
    source = random.Random(f'host {seed}')
    wake = available = 0
    for arrival, received in deliveries:
        if arrival > wake:
            if available:
                yield wake, available
            wake = arrival + _read_delay(case, source, arrival)
        available = received
    if available:
        yield wake, available


def _read_delay(case: Case, source: random.Random, time: int) -> int:
    """Return the delay of a read in ns: at least 40 us, and sometimes much longer."""
    begin, end = (ORIGIN + bound * NS_PER_S for bound in case.overload)
    if begin <= time < end:
        return round(source.uniform(5e6, 200e6))
    late = 40_000 + source.expovariate(1 / 60_000)
    if source.random() < 0.01:
        late += source.uniform(0, 60e6)
    return round(late)
