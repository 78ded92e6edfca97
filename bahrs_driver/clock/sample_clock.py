# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Every stamp of a BAHRS: where the rooms of this package come together.

At each read all messages are looked at first, so that every bound is in the estimate before the
first stamp is made. A sample then gets its stamp if the device's time is known. Until it is,
samples wait in order, 60 of them at most: that is what comes until the third time message. If it
takes longer, or without samples, they get that of their arrival.
"""

from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
from statistics import median_low
from typing import Any, NamedTuple

from bahrs_driver.clock.bounds import ByteBounds
from bahrs_driver.clock.device_time import DeviceTime, Verdict
from bahrs_driver.clock.host import HostClocks, step_sentence
from bahrs_driver.clock.interface import Instant, Stamped, TimeState
from bahrs_driver.clock.options import ClockOptions
from bahrs_driver.clock.output import IMPOSSIBLE, Output
from bahrs_driver.clock.sync_pulses import SyncPulses
from bahrs_driver.clock.tracker import Tracker
from bahrs_driver.clock.units import MICROSECOND, NANOSECONDS
from bahrs_driver.protocol.bahrs import (
    Inertial, InertialTime, Navigation, NavigationTime, SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame

MOST_HELD = 60          # inertial samples
MOST_WAITING = 2 * MOST_HELD        # messages of all kinds
LONGEST_AGO = 10 * NANOSECONDS      # that a message may tell of
SETTLING = 2 * NANOSECONDS          # after which an epoch is the rule, and its end worth a word
CHUNKS = 99             # reads whose size is remembered


class _Waiting(NamedTuple):
    """A message on its way to a stamp: its count, or its own device time."""

    message: Any
    frame: Frame
    bound: int
    place: int | None = None
    device: int | None = None
    feed: bool = False          # a sample that the tracker has yet to be told of


class SampleClock:
    """Puts device time on ROS time."""

    def __init__(self, options: ClockOptions = ClockOptions(),
                 tracker: Tracker | None = None) -> None:
        """Work as the options say, with a tracker that is new; begin() begins."""
        self._options = options
        self._device = DeviceTime(options.label)
        self._tracker = tracker or Tracker()
        self._host = HostClocks()
        self._output = Output(self._host, options.fixed_latency)
        self._pulses = SyncPulses(options.source == 'sync_pulse', options.pulse_period,
                                  options.pulse_times_told)
        self._now = Instant(0, 0)
        self._received = 0
        self._waiting: list[_Waiting] = []
        self._stamped: list[Stamped] = []
        self._patient = True            # whether samples may still be held
        self._epochs = self._arrivals = self._epoch_began = 0
        self._notices: list[str] = []
        self._chunks: deque[int] = deque(maxlen=CHUNKS)
        self._handlers: dict[type, Callable[[Any, Frame, int], _Waiting | None]] = {
            Inertial: self._inertial, Navigation: self._navigation,
            InertialTime: partial(self._time, self._device.inertial_time),
            NavigationTime: partial(self._time, self._device.navigation_time),
            SyncPulseTime: self._pulse}
        self.begin(0)

    def with_tracker(self, tracker: Tracker) -> 'SampleClock':
        """Return a new clock that works as this one, by another tracker."""
        return SampleClock(self._options, tracker)

    def begin(self, byte_time: int) -> None:
        """Take note that another stream begins, and of the ns that a byte takes on its line."""
        self._bounds = ByteBounds(byte_time)
        self._waiting.clear()

    def read(self, now: Instant, received: int) -> None:
        """Take the moment of a read, and how many bytes of the stream there are with it."""
        self._chunks.append(received - self._received)
        self._now, self._received = now, received
        self._bounds.read(now.raw_ns, received)
        step = self._host.read(now)
        if step:
            self._notices.append(step_sentence(step))
        if step < 0:
            self._output.allow_backward()

    def pulse_reference(self, ros_ns: int) -> None:
        """Take the ROS time of a pulse from who knows it. May be called from any thread."""
        self._pulses.reference.tell(ros_ns)

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Take the messages which that read completed, and return those whose time is known."""
        handlers, bound_of = self._handlers, self._bounds.bound
        for message, frame in messages:
            bound = bound_of(frame.offset)
            handler = handlers.get(type(message))
            if handler is None:
                self._stamped.append(Stamped(message, frame, self._output.plain(bound)))
                continue
            waiting = handler(message, frame, bound)
            if waiting:
                self._waiting.append(waiting)
        self._update_pulses()
        self._release()
        stamped, self._stamped = self._stamped, []
        return stamped

    def end(self) -> list[Stamped]:
        """Take note that the stream has ended, and return what still waited for its time."""
        self._stop_waiting()
        stamped, self._stamped = self._stamped, []
        return stamped

    def take_notices(self) -> list[str]:
        """Return what the user should be told since the last call, a sentence each."""
        notices, self._notices = self._notices, []
        return notices

    def _inertial(self, message: Inertial, frame: Frame, bound: int) -> _Waiting:
        device, counter = self._device, self._device.counter
        trusted, lost = True, counter.silence_before(bound)
        if not lost and not counter.follow(message.sequence, bound):
            latest = self._latest_count(bound)
            turned = counter.may_have_turned(message.sequence, latest)
            trusted = turned or counter.place(message.sequence, bound, latest)
            lost = turned or counter.lost
        if lost:
            self._stop_waiting()
            device.lose(message.sequence, bound)
        if trusted and device.known:
            self._tracker.feed(device.time_of(counter.count), bound)
        return _Waiting(message, frame, bound, counter.count, None,
                        trusted and not device.known)

    def _navigation(self, message: Navigation, frame: Frame, bound: int) -> _Waiting:
        return _Waiting(message, frame, bound, self._device.navigation(message.sequence))

    def _time(self, count_of: Callable[[int], int | None],
              message: InertialTime | NavigationTime, frame: Frame, bound: int) -> _Waiting | None:
        count = count_of(message.reference_sequence) if message.valid else None
        if count is None:
            return None
        time = message.device_time_us * MICROSECOND
        was_known = self._device.known
        verdict = self._device.time_message(count, time, self._lateness(count, time, bound))
        if verdict is Verdict.NEW_EPOCH:
            self._begin_epoch()
        if self._device.known and not was_known:
            self._feed_waiting()
        return _Waiting(message, frame, bound, None, time)

    def _pulse(self, message: SyncPulseTime, frame: Frame, bound: int) -> _Waiting:
        time = message.device_time_us * MICROSECOND
        self._pulses.take(time)
        return _Waiting(message, frame, bound, None, time)

    def _latest_count(self, bound: int) -> int | None:
        """Return the highest count that a sample with this bound can have, if known."""
        device, tracker = self._device, self._tracker
        if not device.anchored or not tracker.started:
            return None
        time = device.time_of(device.counter.count)
        return device.count_at(bound - tracker.host_time(time) + time)

    def _lateness(self, count: int, time: int, bound: int) -> int | None:
        """Return by how much a message was later than believed, if a sample has this time."""
        if not self._tracker.started:
            return None
        return bound - self._tracker.host_time(time)

    def _begin_epoch(self) -> None:
        self._epochs += 1
        began, self._epoch_began = self._epoch_began, self._now.raw_ns
        self._tracker.restart()
        self._pulses.restart()
        self._output.restart()
        # What comes first may have waited in the system while nobody read, and prove nothing.
        if self._epochs > 1 and self._epoch_began - began > SETTLING:
            self._notices.append("the device's clock was set anew: was it restarted?")

    def _feed_waiting(self) -> None:
        self._patient = True
        for waiting in self._waiting:
            if waiting.feed and waiting.place is not None:
                self._tracker.feed(self._device.time_of(waiting.place), waiting.bound)

    def _stop_waiting(self) -> None:
        """Release what waits, for what comes next will tell nothing of it."""
        self._stop_doubting()
        self._patient = False
        self._release()
        self._patient = True

    def _stop_doubting(self) -> None:
        if self._waiting and not self._device.known:
            if self._device.stop_doubting() is Verdict.NEW_EPOCH:
                self._begin_epoch()
            if self._device.known:
                self._feed_waiting()

    def _release(self) -> None:
        """Stamp what waits, unless it must wait on."""
        waiting = self._waiting
        if not self._device.known and self._patient:
            samples = sum(type(item.message) is Inertial for item in waiting)
            if samples <= MOST_HELD and len(waiting) <= MOST_WAITING:
                return
            self._stop_doubting()
            self._patient = self._device.known
        known = self._device.known and self._tracker.started
        self._waiting = []
        for item in waiting:
            stamp = self._stamp_of(item) if known else self._arrival_of(item)
            if stamp is not None:
                self._stamped.append(Stamped(item.message, item.frame, stamp))

    def _stamp_of(self, item: _Waiting) -> int | None:
        if item.device is not None:
            return self._point(item.device)
        if item.place is None:
            return self._arrival_of(item)
        device, output = self._device.time_of(item.place), self._output
        if type(item.message) is Navigation and (stamp := output.again(device)) is not None:
            return stamp
        target, skew = self._estimate(device)
        return output.stamp(device, target, skew, item.bound, self._now)

    def _arrival_of(self, item: _Waiting) -> int | None:
        if item.device is not None:         # it is about a time, and that is not known
            return None
        if item.place is None:
            return self._output.plain(item.bound)
        self._arrivals += type(item.message) is Inertial
        return self._output.arrival(item.bound)

    def _point(self, device: int) -> int | None:
        """Return the ROS time of any device time that can be of the present."""
        stamp = self._output.again(device)
        if stamp is None:
            raw, _ = self._estimate(device)
            if -LONGEST_AGO < raw - self._now.raw_ns < IMPOSSIBLE:
                stamp = self._output.plain(raw)
        return stamp

    def _estimate(self, device: int) -> tuple[int, float]:
        """Return the host's raw time for a device time, and the skew."""
        line = self._pulses.line
        if line:
            return line.host_time(device), line.skew
        delay = self._pulses.delay.value if self._pulses.in_charge else None
        return self._tracker.host_time(device) - (delay or 0), self._tracker.skew

    def _update_pulses(self) -> None:
        counter, device = self._device.counter, self._device
        if not device.known or not self._tracker.started:
            return
        changed = self._pulses.update(
            device.time_of(counter.count), self._tracker, self._host)
        if changed:
            self._output.hurry()
            self._notices.append(changed)

    def state(self) -> TimeState:
        """Return how stamps are made at present."""
        device, tracker, pulses = self._device, self._tracker, self._pulses
        known, period = device.known and tracker.started, device.period
        offset = None
        if known:
            time = device.time_of(device.counter.count)
            offset = self._output.plain(self._estimate(time)[0]) - time
        in_use = 'sync_pulse' if known and pulses.line else 'device' if known else 'arrival'
        return TimeState(
            source=self._options.source, in_use=in_use, label=device.labels.reading,
            settled=known, held=len(self._waiting), offset_ns=offset,
            skew_ppm=tracker.skew * 1e6, spread_us=tracker.spread / MICROSECOND,
            period_us=period and period / MICROSECOND, epochs=self._epochs,
            rejected_samples=tracker.rejected, rejected_time_messages=device.rejected,
            rejected_counters=device.counter.rejected, arrival_stamps=self._arrivals,
            dropped=self._output.dropped, host_steps=self._host.steps,
            last_host_step_s=self._host.last_step_ns / NANOSECONDS,
            pulses=pulses.tracker.accepted, pulses_spurious=pulses.tracker.spurious,
            pulses_missing=pulses.tracker.missing,
            pulse_delay_us=None if pulses.delay.value is None
            else pulses.delay.value / MICROSECOND,
            median_chunk=median_low(self._chunks) if self._chunks else 0)
