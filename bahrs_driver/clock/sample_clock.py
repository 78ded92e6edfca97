# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The clock of a device that streams samples and reports device time: it combines this package.

The device numbers its samples with a uint8 counter, and time messages tie some of them to device
time. `device_time` turns counters into device time, an estimate turns device time into host time,
and `stamper` turns host time into stamps.

At each read, all messages are examined first: the estimate includes every bound before the first
message is stamped. Then `stamp_queue` stamps them, or holds them until their time is known.

A stream, or its continuation after a silence, seldom begins with a sample. Messages before the
first sample wait for it, and are then examined as if the sample before it had just arrived: that
one was sent, but not received.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from bahrs_driver.clock.counter import SLACK
from bahrs_driver.clock.device_time import DeviceTime
from bahrs_driver.clock.estimation.estimate import Estimate
from bahrs_driver.clock.estimation.smoother_input import SmootherInput
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.held import HeldMessage, HeldNavigation, HeldSample, HeldTime
from bahrs_driver.clock.interface import Clock, Instant, Smoothing, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.clock.options import ClockOptions
from bahrs_driver.clock.read_observer import ReadObserver
from bahrs_driver.clock.slewer import StampSlewer
from bahrs_driver.clock.stamp_queue import StampQueue
from bahrs_driver.clock.stamper import NoStamper, Stamper
from bahrs_driver.clock.sync_pulses import SyncPulses
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.units import NS_PER_S, NS_PER_US

SETTLING = 2 * NS_PER_S     # the end of a shorter epoch is not reported


class SampleClock(Clock):
    """Stamps messages by device time."""

    def __init__(self, roles: MessageRoles, options: ClockOptions = ClockOptions(),
                 estimate: Estimate | None = None,
                 stamper_type: type[Stamper] = Stamper) -> None:
        """Stamp by an estimate without samples; the default is a new `Tracker`."""
        self._roles, self._options = roles, options
        self._device = DeviceTime(roles, options.label)
        self._estimate = estimate or Tracker()
        self._notices = Notices()
        self._reads = ReadObserver(self._notices)
        self._slewer = StampSlewer(self._reads.host, options.fixed_latency)
        self._pulses = SyncPulses(options.source == 'sync_pulse', options.pulse_period,
                                  options.external_pulse_times)
        self._stamper = stamper_type(
            roles, self._device, self._estimate, self._slewer, self._pulses)
        self._queue = StampQueue(self._device, self._estimate, self._stamper, self._reads,
                                 options.most_held, self._begin_epoch)
        self._epochs = self._epoch_began = 0
        time_of_sample = partial(self._handle_time, self._device.count_for_sample_time)
        time_of_navigation = partial(self._handle_time, self._device.count_for_navigation_time)
        self._handlers: dict[type, tuple[type[HeldMessage], Callable[[Any], None]]] = {
            roles.sample: (HeldSample, self._handle_sample),
            roles.navigation: (HeldNavigation, self._handle_navigation),
            roles.sample_time: (HeldTime, time_of_sample),
            roles.navigation_time: (HeldTime, time_of_navigation),
            roles.sync_pulse: (HeldTime, self._handle_pulse)}

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""
        self._reads.begin(byte_time)
        self._queue.clear()

    def observe_read(self, now: Instant, received: int) -> None:
        """Record the instant of a read, and the bytes of the stream received by then."""
        if self._reads.observe(now, received):
            self._stamper.allow_backward()

    def stamp(self, messages: Iterable[tuple[Message, Frame]]) -> list[Stamped]:
        """Add the messages that the read completed; return all whose time is known."""
        bound = self._reads.bounds.bound
        for message, frame in messages:
            self._examine(message, frame, bound(frame.offset))
        if self._pulses.seen:
            self._update_pulses()
        self._queue.release()
        return self._queue.take_stamped()

    def end(self) -> list[Stamped]:
        """End the stream; return the messages that still waited for a stamp."""
        self._queue.stop_holding()
        return self._queue.take_stamped()

    def pulse_reference(self, ros_ns: int) -> None:
        """Add the ROS time of an external sync pulse. Any thread may call it."""
        self._pulses.reference.add(ros_ns)

    def take_notices(self) -> list[str]:
        """Return the sentences for the user since the last call."""
        return self._notices.take()

    def smoothing(self) -> Smoothing:
        """Return clocks for two passes over a recording."""
        smoother_input = SmootherInput()
        return Smoothing(
            SampleClock(self._roles, self._options, smoother_input, NoStamper),
            lambda: SampleClock(self._roles, self._options, smoother_input.smoothed()))

    def state(self) -> TimeState:
        """Return the present state."""
        device, estimate, pulses = self._device, self._estimate, self._pulses
        host, delay, period = self._reads.host, pulses.delay.value, device.period
        known, offset = device.known and estimate.started, None
        if known:
            time = device.time_of(device.counter.count)
            offset = self._slewer.to_ros_time(self._stamper.host_time(time)[0]) - time
        in_use = 'sync_pulse' if pulses.active_tracker else 'device'
        return TimeState(
            source=self._options.source, in_use=in_use if known else 'arrival',
            label=device.convention.label, settled=known, held=len(self._queue), offset_ns=offset,
            skew_ppm=estimate.skew * 1e6, spread_us=estimate.spread / NS_PER_US,
            period_us=None if period is None else period / NS_PER_US, epochs=self._epochs,
            rejected_samples=estimate.rejected, rejected_time_messages=device.rejected,
            rejected_counters=device.counter.rejected, arrival_stamps=self._stamper.arrivals,
            dropped=self._stamper.dropped, host_steps=host.steps,
            last_host_step_s=host.last_step_ns / NS_PER_S, pulses=pulses.tracker.accepted,
            pulses_spurious=pulses.tracker.spurious, pulses_missing=pulses.tracker.missing,
            pulse_delay_us=None if delay is None else delay / NS_PER_US,
            median_chunk=self._reads.median_chunk)

    def _examine(self, message: Message, frame: Frame, bound: int) -> None:
        """Learn from a message about device time, and hold it behind the others."""
        kind, device = type(message), self._device
        handling = self._handlers.get(kind)
        if handling is None or not getattr(message, 'valid', True):
            self._handle_interruption(kind)
            self._queue.hold(HeldMessage(message, frame, bound))
            return
        if not device.awaits_sample and device.counter.silence_before(bound):
            self._queue.stop_holding()
            self._stamper.lose_count()
            device.await_sample()
        held_type, handle = handling
        item = held_type(message, frame, bound)
        if device.awaits_sample and kind is not self._roles.sample:
            self._queue.hold_early(item)
        else:
            handle(item)
            self._queue.hold(item)

    def _handle_interruption(self, kind: type) -> None:
        """Stop holding if no later time message can apply to the held samples."""
        if kind is self._roles.power_on:
            self._queue.stop_holding()
            self._stamper.lose_count()
            self._device.discard()
        elif kind in self._roles.service:
            self._queue.stop_holding()

    def _handle_sample(self, item: HeldSample) -> None:
        device, counter, bound = self._device, self._device.counter, item.bound
        sequence = item.message.sequence
        if device.awaits_sample:
            self._resume_count(sequence, bound)
        plausible = counter.advance(sequence, bound) or self._add_after_gap(sequence, bound)
        item.count, item.plausible = counter.count, plausible
        if plausible and device.known:
            self._estimate.feed(device.time_of(counter.count), bound)
        item.feed_later = plausible and not device.known

    def _add_after_gap(self, sequence: int, bound: int) -> bool:
        """Count a sample that does not follow the latest one; return whether it is plausible."""
        counter, highest = self._device.counter, self._highest_count(bound)
        ambiguous = counter.may_have_wrapped(sequence, highest) or counter.is_far(
            sequence, bound, highest)
        plausible = ambiguous or counter.add(sequence, bound, highest)
        if ambiguous or counter.lost:
            self._queue.stop_holding()
            self._device.jump_count(sequence, bound)
            self._stamper.lose_count()
        return plausible

    def _resume_count(self, sequence: int, bound: int) -> None:
        """Continue the count with the next sample, and examine the messages before it."""
        self._device.resume_count(sequence, bound)
        for item in self._queue.take_early():
            if isinstance(item, HeldNavigation):
                item.preceding_lost = True
            _, handle = self._handlers[type(item.message)]
            handle(item)

    def _handle_navigation(self, item: HeldNavigation) -> None:
        self._device.pair(item.message.sequence)
        item.preceding = self._device.counter.latest

    def _handle_time(self, referenced: Callable[[int], int | None], item: HeldTime) -> None:
        message, was_known = item.message, self._device.known
        item.device_time = time = message.device_time_us * NS_PER_US
        count = referenced(message.reference_sequence)
        if count is None:
            return
        lateness = self._lateness(time, item.bound)
        if was_known and not self._device.agrees(count, time):
            self._queue.stamp_held(known=True)      # earlier messages keep the present timeline
        if self._device.add_time(count, time, lateness):
            self._begin_epoch()
        if self._device.known and not was_known:
            self._queue.feed_held()

    def _handle_pulse(self, item: HeldTime) -> None:
        item.device_time = item.message.device_time_us * NS_PER_US
        self._pulses.add(item.device_time)

    def _highest_count(self, bound: int) -> int | None:
        """Return the highest count that a sample with this bound can have, if known."""
        device, estimate = self._device, self._estimate
        if not device.anchored or not estimate.started:
            return None
        time = device.time_of(device.counter.count)
        slack = SLACK if estimate.rough else 0
        return device.count_at(bound + slack - estimate.host_time(time) + time)

    def _lateness(self, time: int, bound: int) -> int | None:
        """Return how much later than estimated a sample with this device time arrived."""
        estimate = self._estimate
        return bound - estimate.host_time(time) if estimate.started else None

    def _begin_epoch(self) -> None:
        self._epochs += 1
        began, self._epoch_began = self._epoch_began, self._reads.now.raw_ns
        self._estimate.restart()
        self._pulses.restart()
        self._slewer.restart()
        # The first messages may be old ones from a buffer of the system: they prove no restart.
        if self._epochs > 1 and self._epoch_began - began > SETTLING:
            self._notices.add("the device's clock has jumped: was the device restarted?")

    def _update_pulses(self) -> None:
        device, estimate = self._device, self._estimate
        if device.known and estimate.started and (
                notice := self._pulses.update(
                    device.time_of(device.counter.count), estimate, self._reads.host)):
            self._slewer.allow_fast_slew()
            self._notices.add(notice)
