# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The stamp of each message, once it is its turn.

A sample has the stamp of its device time. A navigation message has the stamp of its inertial
sample, and a time message that of the sample that it is about, so that what is of one time is
under one stamp. A pulse has a time of its own, however near a sample it was. Without device time
a sample has the stamp of its arrival, as even as its count and the nominal period make it.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from bahrs_driver.clock.counter import PERIOD
from bahrs_driver.clock.device_time import DeviceTime
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.held import Held
from bahrs_driver.clock.interface import Instant
from bahrs_driver.clock.slewer import IMPOSSIBLE, Output
from bahrs_driver.clock.sync_pulses import SyncPulses
from bahrs_driver.protocol.bahrs.messages import Inertial, SyncPulseTime
from bahrs_driver.units import NS_PER_MS, NS_PER_S

LONGEST_AGO = 10 * NS_PER_S         # the oldest time that a message may have
SAME = NS_PER_MS        # device times that differ by less are of one sample


@dataclass(frozen=True, slots=True)
class _Latest:
    """The sample that was stamped last."""

    count: int | None
    device: int | None      # device time, if it was known
    stamp: int


class Stamper:
    """Stamps messages by device time, or by arrival if that is not known."""

    def __init__(self, device: DeviceTime, tracker: Tracker, output: Output,
                 pulses: SyncPulses) -> None:
        self.arrivals = 0               # inertial samples stamped without device time
        self.dropped = 0                # samples whose time cannot be
        self._device, self._tracker = device, tracker
        self._output, self._pulses = output, pulses
        self._latest: _Latest | None = None
        self._by_count = Tracker()

    def lose_count(self) -> None:
        """Forget how counts go with host time: they do not go on."""
        self._by_count.restart()

    def take_arrivals(self, items: Iterable[Held]) -> None:
        """Take samples that are going to be stamped without device time."""
        for item in items:
            if item.count is not None:
                self._by_count.feed(item.count * PERIOD, item.bound)

    def allow_backward(self) -> None:
        """Let the next stamp be earlier than the last: the host was set back."""
        self._output.allow_backward()
        self._latest = None

    def stamp(self, item: Held, known: bool, now: Instant) -> int | None:
        """
        Return the stamp of the next message; None if its time cannot be.

        known is whether device time is, now the latest read.
        """
        if not item.timed:
            return self._output.plain(item.bound)
        if item.device is not None:         # it is about a time
            stamp = self._point(item, item.device, now) if known else None
        else:
            stamp = self._sample(item, known, now)
            self.dropped += stamp is None
        kind = type(item.message)
        return stamp if stamp is None or kind is Inertial else self._output.in_order(kind, stamp)

    def estimate(self, device: int) -> tuple[int, float]:
        """Return the host's raw time for a device time, and the skew."""
        line = self._pulses.line
        if line:
            return line.host_time(device), line.skew
        delay = self._pulses.delay.value if self._pulses.in_charge else None
        return self._tracker.host_time(device) - (delay or 0), self._tracker.skew

    def _sample(self, item: Held, known: bool, now: Instant) -> int | None:
        """Return the stamp of an inertial or navigation message."""
        if not item.near:
            return self._new_sample(item, item.count, known, now)
        before = item.near.count
        count = self._device.navigation.count(item.message.sequence, item.near)
        if count is None or (count < before and not item.early):
            count = before              # it follows its sample, or one before that
        stamp = self._navigation(item, count, known, now)
        return self._navigation(item, before, known, now) if stamp is None else stamp

    def _navigation(self, item: Held, count: int, known: bool, now: Instant) -> int | None:
        """Return the stamp of the sample with this count, which may have it already."""
        if self._latest and self._latest.count == count:
            return self._latest.stamp
        return self._new_sample(item, count, known, now)

    def _new_sample(self, item: Held, count: int | None, known: bool, now: Instant) -> int | None:
        device = None
        if known and count is not None:
            device = self._device.time_of(count)
            target, skew = self.estimate(device)
            stamp = self._output.stamp(device, target, skew, item.bound, now)
            if stamp is None:
                return None
        else:
            self.arrivals += type(item.message) is Inertial
            arrival = item.bound
            if count is not None and self._by_count.started:
                arrival = min(arrival, self._by_count.host_time(count * PERIOD))
            stamp = self._output.arrival(arrival)
        self._latest = _Latest(count, device, stamp)
        return stamp

    def _point(self, item: Held, device: int, now: Instant) -> int | None:
        """Return the ROS time of any device time that can be of the present."""
        latest = self._latest
        if latest and latest.device is not None and type(item.message) is not SyncPulseTime \
                and abs(device - latest.device) < SAME:
            return latest.stamp
        raw, _ = self.estimate(device)
        if -LONGEST_AGO < raw - now.raw_ns < IMPOSSIBLE:
            return self._output.between(raw, item.bound)
        return None
