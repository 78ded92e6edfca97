# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Messages in the order of the stream, held until the first of them can be stamped.

A sample is stamped if its device time is known and more than the first few samples support the
estimate. Until then samples are held, 60 at most: as many as arrive until the third time message.
If it takes longer, or if there are no samples, stamps are arrivals.

Messages behind a held sample are held with it, even if they need no time: an accuracy message
applies to the navigation messages after it, not to those before it, and the order must not depend
on where the adapter cuts the stream.
"""

from collections.abc import Callable

from bahrs_driver.clock.device_time import DeviceTime
from bahrs_driver.clock.estimation.estimate import Estimate
from bahrs_driver.clock.held import HeldMessage, HeldSample
from bahrs_driver.clock.interface import Stamped
from bahrs_driver.clock.read_observer import ReadObserver
from bahrs_driver.clock.stamper import Stamper

MESSAGES_PER_SAMPLE = 2     # messages of all types that may be held


class StampQueue:
    """Holds messages, and stamps them as soon as waiting no longer improves their stamps."""

    def __init__(self, device: DeviceTime, estimate: Estimate, stamper: Stamper,
                 reads: ReadObserver, most_samples: int, begin_epoch: Callable[[], None]) -> None:
        """Hold at most most_samples samples; call begin_epoch if the device's clock jumped."""
        self._device, self._estimate = device, estimate
        self._stamper, self._reads = stamper, reads
        self._most_samples = most_samples
        self._begin_epoch = begin_epoch
        self._held: list[HeldMessage] = []
        self._early: list[HeldMessage] = []     # held messages before the first sample
        self._may_hold = True           # False after device time was awaited in vain
        self._stamped: list[Stamped] = []

    def __len__(self) -> int:
        """Return the count of held messages."""
        return len(self._held)

    def clear(self) -> None:
        """Drop the held messages: another stream begins."""
        self._held.clear()
        self._early.clear()

    def hold(self, item: HeldMessage) -> None:
        """Add the next message of the stream."""
        self._held.append(item)

    def hold_early(self, item: HeldMessage) -> None:
        """Add the next message of the stream, which waits for the first sample."""
        self._early.append(item)
        self._held.append(item)

    def take_early(self) -> list[HeldMessage]:
        """Return the held messages that waited for the first sample, which has come."""
        self._may_hold = True
        early, self._early = self._early, []
        return early

    def feed_held(self) -> None:
        """Add the held samples to the estimate, now that their device times are known."""
        self._may_hold = True
        for item in self._held:
            if isinstance(item, HeldSample) and item.feed_later:
                self._estimate.feed(self._device.time_of(item.count), item.bound)
                item.feed_later = False

    def stop_holding(self) -> None:
        """Stamp the held messages now, because later messages do not improve their time."""
        self._stop_doubting()
        self.stamp_held(self._device.known)
        self._may_hold = True

    def release(self) -> None:
        """Stamp the held messages, unless they can wait for a better time."""
        if not self._held:
            return
        waiting = self._may_hold and not self._ready and any(item.timed for item in self._held)
        if waiting and not self._full:
            return
        if waiting:
            self._stop_doubting()
            self._may_hold = self._ready
        self.stamp_held(self._device.known)

    def stamp_held(self, known: bool) -> None:
        """Stamp all held messages: by device time if it is known, else by arrival."""
        known = known and self._estimate.started
        items, self._held = self._held, []
        self._early.clear()
        if not known:
            self._stamper.add_arrivals(items)
        for item in items:
            stamp = self._stamper.stamp(item, known, self._reads.now)
            if stamp is not None:
                self._stamped.append(Stamped(item.message, item.frame, stamp))

    def take_stamped(self) -> list[Stamped]:
        """Return the messages stamped since the last call, in the order of the stream."""
        stamped, self._stamped = self._stamped, []
        return stamped

    @property
    def _ready(self) -> bool:
        return self._device.known and self._estimate.ready

    @property
    def _full(self) -> bool:
        samples = sum(isinstance(item, HeldSample) for item in self._held)
        return samples > self._most_samples or \
            len(self._held) > MESSAGES_PER_SAMPLE * self._most_samples

    def _stop_doubting(self) -> None:
        """Trust what is known of device time, if held messages need it."""
        if self._held and not self._device.known:
            if self._device.stop_doubting():
                self._begin_epoch()
            if self._device.known:
                self.feed_held()
