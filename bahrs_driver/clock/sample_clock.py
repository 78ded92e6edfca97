# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Every stamp of a BAHRS: where the rooms of this package come together.

At each read all messages are looked at first, so that every bound is in the estimate before the
first stamp is made. A sample then gets its stamp if the device's time is known, and more than a
few samples have shown when they came. Until then samples are held, 60 of them at most: that is
what comes until the third time message. If it takes longer, or without samples, they get that of
their arrival. Messages leave in the order of the stream, also those that need no time: what
follows a sample that is held is held with it.

A stream, or what comes after a silence, seldom begins with an inertial message. What comes before
the first one is looked at together with it, as if the sample before that had just come: it was
sent, but not received.
"""

from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
from statistics import median_low
from typing import Any

from bahrs_driver.clock.bounds import ByteBounds
from bahrs_driver.clock.counter import SLACK
from bahrs_driver.clock.device_time import DeviceTime, Verdict
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.held import Held, HeldMessages
from bahrs_driver.clock.host import HostClocks, step_sentence
from bahrs_driver.clock.interface import Instant, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.clock.options import ClockOptions
from bahrs_driver.clock.slewer import Output
from bahrs_driver.clock.stamper import Stamper
from bahrs_driver.clock.sync_pulses import SyncPulses
from bahrs_driver.protocol.bahrs.messages import (
    BahrsMessage, Inertial, InertialTime, Navigation, NavigationTime, SoftwareVersion,
    SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import NS_PER_S, NS_PER_US

SETTLING = 2 * NS_PER_S             # after which an epoch is the rule, and its end worth a word
CHUNKS = 99             # reads whose size is remembered


class SampleClock:
    """Puts device time on ROS time."""

    def __init__(self, options: ClockOptions = ClockOptions(),
                 tracker: Tracker | None = None) -> None:
        self._options = options
        self._device = DeviceTime(options.label)
        self._tracker = tracker or Tracker()
        self._host = HostClocks()
        self._output = Output(self._host, options.fixed_latency)
        self._pulses = SyncPulses(options.source == 'sync_pulse', options.pulse_period,
                                  options.pulse_times_told)
        self._stamper = Stamper(self._device, self._tracker, self._output, self._pulses)
        self._now = Instant(0, 0)
        self._received = 0
        self._held = HeldMessages(options.most_held)
        self._early: list[Held] = []    # of them, what needs the count of the next sample
        self._stamped: list[Stamped] = []
        self._patient = True            # whether samples may still be held
        self._epochs = self._epoch_began = 0
        self._notices = Notices()
        self._chunks: deque[int] = deque(maxlen=CHUNKS)
        self._handlers: dict[type, Callable[[Held], None]] = {
            Inertial: self._inertial, Navigation: self._navigation,
            InertialTime: partial(self._time, self._device.inertial_time),
            NavigationTime: partial(self._time, self._device.navigation_time),
            SyncPulseTime: self._pulse}
        self.begin(0)

    def with_tracker(self, tracker: Tracker) -> 'SampleClock':
        """Return a new clock that works as this one, by another tracker."""
        return SampleClock(self._options, tracker)

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on whose line a byte takes byte_time ns."""
        self._bounds = ByteBounds(byte_time)
        self._held.take_all()
        self._early.clear()

    def read(self, now: Instant, received: int) -> None:
        """Take the moment of a read, and how many bytes of the stream there are with it."""
        self._chunks.append(received - self._received)
        self._now, self._received = now, received
        self._bounds.read(now.raw_ns, received)
        step = self._host.read(now)
        if step:
            self._notices.add(step_sentence(step))
        if step < 0:
            self._stamper.allow_backward()

    def pulse_reference(self, ros_ns: int) -> None:
        """Take the ROS time of a pulse from who knows it. May be called from any thread."""
        self._pulses.reference.tell(ros_ns)

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Stamp the messages that the read completed; return those whose time is known."""
        for message, frame in messages:
            self._take(Held(message, frame, self._bounds.bound(frame.offset)))
        self._update_pulses()
        self._release()
        stamped, self._stamped = self._stamped, []
        return stamped

    def end(self) -> list[Stamped]:
        """End the stream, and return the messages that still waited for a stamp."""
        self._stop_holding()
        stamped, self._stamped = self._stamped, []
        return stamped

    def take_notices(self) -> list[str]:
        """Return the notices for the user since the last call, a sentence each."""
        return self._notices.take()

    def _take(self, item: Held) -> None:
        """Look at a message, and put it behind those that are held."""
        kind, device = type(item.message), self._device
        handler = self._handlers.get(kind)
        if handler is None or not getattr(item.message, 'valid', True):
            self._interrupt(item.message)
        else:
            item.timed = True
            if not device.adrift and device.counter.silence_before(item.bound):
                self._stop_holding()
                self._stamper.lose_count()
                device.cut_adrift()
            if device.adrift and kind is not Inertial:
                self._early.append(item)
            else:
                handler(item)
        self._held.items.append(item)

    def _interrupt(self, message: Any) -> None:
        """Stop holding if no time message can tell any more of what is held."""
        if isinstance(message, SoftwareVersion):        # sent once, right after power-on
            self._stop_holding()
            self._stamper.lose_count()
            self._device.forget()
        elif isinstance(message, BahrsMessage) and message.SERVICE:
            self._stop_holding()        # a device that answers has ceased to stream

    def _inertial(self, item: Held) -> None:
        device, counter, bound = self._device, self._device.counter, item.bound
        sequence, trusted = item.message.sequence, True
        if device.adrift:
            self._end_drift(sequence, bound)
        if not counter.follow(sequence, bound):
            latest = self._latest_count(bound)
            unclear = counter.may_have_turned(sequence, latest) or counter.far(
                sequence, bound, latest)
            trusted = unclear or counter.place(sequence, bound, latest)
            if unclear or counter.lost:
                self._stop_holding()
                device.lose(sequence, bound)
                self._stamper.lose_count()
        item.count = counter.count
        if trusted and device.known:
            self._tracker.feed(device.time_of(counter.count), bound)
        item.unfed = trusted and not device.known

    def _end_drift(self, sequence: int, bound: int) -> None:
        """Take up counting with the next sample, and look at what came before it."""
        self._device.find(sequence, bound)
        self._patient = True
        early, self._early = self._early, []
        for item in early:
            item.early = True
            self._handlers[type(item.message)](item)

    def _navigation(self, item: Held) -> None:
        self._device.pair(item.message.sequence)
        item.near = self._device.counter.latest

    def _time(self, count_of: Callable[[int], int | None], item: Held) -> None:
        message, was_known = item.message, self._device.known
        item.device = time = message.device_time_us * NS_PER_US
        count = count_of(message.reference_sequence)
        if count is None:
            return
        lateness = self._lateness(time, item.bound)
        if was_known and not self._device.agrees(count, time):
            self._give(True)            # what came before it is known, whatever it means
        verdict = self._device.time_message(count, time, lateness)
        if verdict is Verdict.NEW_EPOCH:
            self._begin_epoch()
        if self._device.known and not was_known:
            self._feed_held()

    def _pulse(self, item: Held) -> None:
        device: int = item.message.device_time_us * NS_PER_US
        item.device = device
        self._pulses.take(device)

    def _latest_count(self, bound: int) -> int | None:
        """Return the highest count that a sample with this bound can have, if known."""
        device, tracker = self._device, self._tracker
        if not device.anchored or not tracker.started:
            return None
        time = device.time_of(device.counter.count)
        slack = SLACK if tracker.rough else 0
        return device.count_at(bound + slack - tracker.host_time(time) + time)

    def _lateness(self, time: int, bound: int) -> int | None:
        """Return by how much a message was later than believed, if a sample has this time."""
        tracker = self._tracker
        return bound - tracker.host_time(time) if tracker.started else None

    def _begin_epoch(self) -> None:
        self._epochs += 1
        began, self._epoch_began = self._epoch_began, self._now.raw_ns
        self._tracker.restart()
        self._pulses.restart()
        self._output.restart()
        # What comes first may have waited in the system while nobody read, and prove nothing.
        if self._epochs > 1 and self._epoch_began - began > SETTLING:
            self._notices.add("the device's clock has jumped: was the device restarted?")

    def _feed_held(self) -> None:
        self._patient = True
        for item in self._held.items:
            if item.unfed and item.count is not None:
                self._tracker.feed(self._device.time_of(item.count), item.bound)
                item.unfed = False

    def _stop_holding(self) -> None:
        """Release what is held: later messages will not help to time it."""
        self._stop_doubting()
        self._give(self._device.known)
        self._patient = True

    def _stop_doubting(self) -> None:
        if len(self._held) and not self._device.known:
            if self._device.stop_doubting() is Verdict.NEW_EPOCH:
                self._begin_epoch()
            if self._device.known:
                self._feed_held()

    def _release(self) -> None:
        """Stamp what is held, unless it must be held on."""
        if not self._ready and self._patient and self._held.timed:
            if not self._held.full:
                return
            self._stop_doubting()
            self._patient = self._ready
        self._give(self._device.known)

    @property
    def _ready(self) -> bool:
        return self._device.known and self._tracker.ready

    def _give(self, known: bool) -> None:
        """Stamp all that is held: by device time if it is known, or else by arrival."""
        known = known and self._tracker.started
        self._early.clear()
        items = self._held.take_all()
        if not known:
            self._stamper.take_arrivals(items)
        for item in items:
            stamp = self._stamper.stamp(item, known, self._now)
            if stamp is not None:
                self._stamped.append(Stamped(item.message, item.frame, stamp))

    def _update_pulses(self) -> None:
        device, tracker = self._device, self._tracker
        if device.known and tracker.started and (changed := self._pulses.update(
                device.time_of(device.counter.count), tracker, self._host)):
            self._output.hurry()
            self._notices.add(changed)

    def state(self) -> TimeState:
        """Return how stamps are made at present."""
        device, tracker, pulses = self._device, self._tracker, self._pulses
        known, period = device.known and tracker.started, device.period
        offset = None
        if known:
            time = device.time_of(device.counter.count)
            offset = self._output.plain(self._stamper.estimate(time)[0]) - time
        in_use = 'sync_pulse' if known and pulses.line else 'device' if known else 'arrival'
        return TimeState(
            source=self._options.source, in_use=in_use, label=device.labels.reading,
            settled=known, held=len(self._held), offset_ns=offset,
            skew_ppm=tracker.skew * 1e6, spread_us=tracker.spread / NS_PER_US,
            period_us=period and period / NS_PER_US, epochs=self._epochs,
            rejected_samples=tracker.rejected, rejected_time_messages=device.rejected,
            rejected_counters=device.counter.rejected, arrival_stamps=self._stamper.arrivals,
            dropped=self._stamper.dropped, host_steps=self._host.steps,
            last_host_step_s=self._host.last_step_ns / NS_PER_S,
            pulses=pulses.tracker.accepted, pulses_spurious=pulses.tracker.spurious,
            pulses_missing=pulses.tracker.missing,
            pulse_delay_us=None if pulses.delay.value is None
            else pulses.delay.value / NS_PER_US,
            median_chunk=median_low(self._chunks) if self._chunks else 0)
