# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The pulses of one device: matched, tracked, and told of when they come and go."""

from collections import deque

from bahrs_driver.clock.estimation.pulses import (
    DelayEstimate, PENDING, PulseReference, PulseTracker)
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.units import NS_PER_MS

# What a pulse can say of the delay of the fastest samples. They are never early, and a pulse that
# says so, or that they are very late, is not the one that it was taken for.
EARLIEST, LATEST = -NS_PER_MS, 100 * NS_PER_MS


class SyncPulses:
    """Takes device times of pulses, and offers a line through them."""

    def __init__(self, in_charge: bool, period: int, told: bool) -> None:
        """Take whether stamps are to follow pulses, their period in ns, and who tells of them."""
        self.in_charge = in_charge
        self.tracker = PulseTracker(period)
        self.reference = PulseReference(period, told)
        self.delay = DelayEstimate()
        self._pending: deque[int] = deque(maxlen=PENDING)
        self._settled = False

    @property
    def line(self) -> PulseTracker | None:
        """Return the tracker if stamps are to follow it now."""
        return self.tracker if self.in_charge and self.tracker.settled else None

    def restart(self) -> None:
        """Begin anew with the device's clock; what the delay is stays known."""
        self.tracker.restart()
        self._pending.clear()
        self._settled = False

    def take(self, device: int) -> None:
        """Take the device time of a pulse."""
        if device not in self._pending:
            self._pending.append(device)

    def update(self, device: int, passive: Tracker, host: HostClocks) -> str:
        """
        Use the pulses that were taken; device is the present device time.

        Return a sentence if stamps begin or cease to follow the pulses.
        """
        for _ in range(len(self._pending)):
            pulse = self._pending.popleft()
            if not self._match(pulse, passive, host):
                self._pending.append(pulse)
        self.tracker.lost(device)
        settled, self._settled = self._settled, self.tracker.settled
        if settled == self._settled or not self.in_charge:
            return ''
        return 'stamps follow the sync pulses' if self._settled else \
            'sync pulses are missing: stamps follow the arrival of samples'

    def _match(self, pulse: int, passive: Tracker, host: HostClocks) -> bool:
        """Find the host's time of a pulse and take it; return False if that is not known yet."""
        raw = passive.host_time(pulse)
        about = host.ros(raw)
        told = self.reference.find(about)
        if told is None:
            return False
        true_raw = raw + told - about
        if not EARLIEST < raw - true_raw < LATEST:
            self.tracker.spurious += 1
        elif self.tracker.feed(pulse, true_raw, passive.skew, passive.skew_deviation):
            self.delay.add(raw - true_raw)
        return True
