# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The stamp of each message, in the order of the stream.

The stamp of a sample is its device time. A navigation message has the stamp of its sample, and a
time message has that of the sample whose time it contains: all messages about one time have the
same stamp. A pulse has a time of its own, even close to a sample. Without device time the stamp of
a sample is its arrival, smoothed by its count and the nominal period.
"""

from collections.abc import Iterable
from typing import NamedTuple

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.device_time import DeviceTime
from bahrs_driver.clock.estimation.estimate import Estimate
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.held import HeldMessage, HeldNavigation, HeldSample, HeldTime
from bahrs_driver.clock.interface import Instant
from bahrs_driver.clock.slewer import IMPOSSIBLE, StampSlewer
from bahrs_driver.clock.sync_pulses import SyncPulses
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.units import NS_PER_MS, NS_PER_S

MAX_AGE = 10 * NS_PER_S         # of the time in a message
SAME_SAMPLE = NS_PER_MS         # device times that differ by less belong to one sample


class _Latest(NamedTuple):
    """The latest sample with a stamp."""

    sample_count: int | None
    device: int | None      # device time, if it was known
    stamp: int


class Stamper:
    """Stamps messages by device time, or by arrival if device time is not known."""

    def __init__(self, roles: MessageRoles, device: DeviceTime, estimate: Estimate,
                 slewer: StampSlewer, pulses: SyncPulses) -> None:
        self.arrivals = 0               # samples stamped without device time
        self.dropped = 0                # samples and navigation messages with an impossible time
        self._roles = roles
        self._device, self._estimate = device, estimate
        self._slewer, self._pulses = slewer, pulses
        self._latest: _Latest | None = None
        self._by_count = Tracker()      # arrival by count, while device time is not known

    def lose_count(self) -> None:
        """Discard the relation of counts to arrivals: the count was interrupted."""
        self._by_count.restart()

    def add_arrivals(self, items: Iterable[HeldMessage]) -> None:
        """Add samples that are about to be stamped without device time."""
        for item in items:
            if isinstance(item, HeldSample):
                self._by_count.feed(item.count * self._roles.sample_period, item.bound)

    def allow_backward(self) -> None:
        """Allow the next stamp to precede the last: the host's clock was set back."""
        self._slewer.allow_backward()
        self._latest = None

    def stamp(self, item: HeldMessage, known: bool, now: Instant) -> int | None:
        """
        Return the stamp of the next message, or None if its time is impossible.

        known is whether device time is known, now the latest read.
        """
        if not item.timed:
            return self._slewer.to_ros_time(item.bound)
        if isinstance(item, HeldTime) and item.device_time is not None:
            stamp = self._stamp_device_time(item, item.device_time, now) if known else None
        else:
            stamp = self._stamp_sample_time(item, known, now)
            self.dropped += stamp is None
        if stamp is None or isinstance(item, HeldSample):
            return stamp
        return self._slewer.in_order(type(item.message), stamp)

    def host_time(self, device: int) -> tuple[int, float]:
        """Return the raw time of a device time, and the skew."""
        estimate, pulses = self._estimate, self._pulses
        if not pulses.enabled:
            return estimate.host_time(device), estimate.skew
        if tracker := pulses.active_tracker:
            return tracker.host_time(device), tracker.skew
        return estimate.host_time(device) - (pulses.delay.value or 0), estimate.skew

    def _stamp_sample_time(self, item: HeldMessage, known: bool, now: Instant) -> int | None:
        """Return the stamp of a sample, or of a message that belongs to one."""
        if isinstance(item, HeldNavigation) and item.preceding:
            return self._stamp_navigation(item, item.preceding, known, now)
        count = item.count if isinstance(item, HeldSample) else None
        return self._stamp_count(item, count, known, now)

    def _stamp_navigation(self, item: HeldNavigation, preceding: CountedSequence, known: bool,
                          now: Instant) -> int | None:
        """Return the stamp of the sample that a navigation message was computed from."""
        count = self._device.navigation.count(item.message.sequence, preceding)
        if count is None or (count < preceding.count and not item.preceding_lost):
            count = preceding.count     # a navigation message follows its sample
        stamp = self._reuse_or_stamp(item, count, known, now)
        if stamp is None:               # that sample is impossible
            stamp = self._reuse_or_stamp(item, preceding.count, known, now)
        return stamp

    def _reuse_or_stamp(self, item: HeldMessage, count: int, known: bool,
                        now: Instant) -> int | None:
        """Return the stamp of the latest sample if it has this count, else a new one."""
        if self._latest and self._latest.sample_count == count:
            return self._latest.stamp
        return self._stamp_count(item, count, known, now)

    def _stamp_count(self, item: HeldMessage, count: int | None, known: bool,
                     now: Instant) -> int | None:
        """Stamp the sample with this count; it becomes the latest sample."""
        device = None
        if known and count is not None:
            device = self._device.time_of(count)
            target, skew = self.host_time(device)
            stamp = self._slewer.stamp(device, target, skew, item.bound, now)
            if stamp is None and isinstance(item, HeldSample) and item.plausible:
                stamp = self._slewer.stamp_arrival(item.bound)  # the estimate is late
            if stamp is None:
                return None
        else:
            self.arrivals += isinstance(item, HeldSample)
            arrival = item.bound
            if count is not None and self._by_count.started:
                arrival = min(arrival, self._by_count.host_time(
                    count * self._roles.sample_period))
            stamp = self._slewer.stamp_arrival(arrival)
        self._latest = _Latest(count, device, stamp)
        return stamp

    def _stamp_device_time(self, item: HeldTime, device: int, now: Instant) -> int | None:
        """Return the ROS time of the device time in a message, unless it is far from now."""
        latest = self._latest
        if latest and latest.device is not None \
                and type(item.message) is not self._roles.sync_pulse \
                and abs(device - latest.device) < SAME_SAMPLE:
            return latest.stamp
        raw, _ = self.host_time(device)
        if -MAX_AGE < raw - now.raw_ns < IMPOSSIBLE:
            return self._slewer.stamp_between(raw, item.bound)
        return None


class NoStamper(Stamper):
    """The stamper of a first pass over a recording, which drops all messages."""

    def add_arrivals(self, items: Iterable[HeldMessage]) -> None:
        """Do nothing."""

    def stamp(self, _item: HeldMessage, _known: bool, _now: Instant) -> None:
        """Return None: the message is dropped."""
