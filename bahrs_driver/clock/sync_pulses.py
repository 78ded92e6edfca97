# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The sync pulses of a device: matched to ROS time, tracked, and reported when they change."""

from collections import deque

from bahrs_driver.clock.estimation.estimate import Estimate
from bahrs_driver.clock.estimation.pulses import (
    DelayEstimate, PENDING, PulseReference, PulseTracker)
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.units import NS_PER_MS

# The delay of the fastest samples by a pulse. Samples are never early: a pulse with another delay
# is not the one that it was matched with.
EARLIEST, LATEST = -NS_PER_MS, 100 * NS_PER_MS


class SyncPulses:
    """Matches the device times of pulses with ROS time, and offers an estimate by them."""

    def __init__(self, enabled: bool, period: int, external_times: bool) -> None:
        """
        Start without a pulse.

        enabled is whether stamps follow pulses, period that of the pulses in ns, external_times
        whether their ROS times are reported rather than whole periods.
        """
        self.enabled = enabled
        self.seen = False               # whether there was a pulse
        self.tracker = PulseTracker(period)
        self.reference = PulseReference(period, external_times)
        self.delay = DelayEstimate()
        self._pending: deque[int] = deque(maxlen=PENDING)
        self._settled = False

    @property
    def active_tracker(self) -> PulseTracker | None:
        """Return the tracker if stamps follow it at present."""
        return self.tracker if self.enabled and self.tracker.settled else None

    def restart(self) -> None:
        """Begin another epoch of the device's clock; the delay stays known."""
        self.tracker.restart()
        self._pending.clear()
        self._settled = False

    def add(self, device: int) -> None:
        """Add the device time of a pulse."""
        self.seen = True
        if device not in self._pending:
            self._pending.append(device)

    def update(self, device: int, passive: Estimate, host: HostClocks) -> str:
        """
        Match the pulses that were added; device is the present device time.

        Return a notice if stamps begin or cease to follow the pulses, else an empty string.
        """
        for _ in range(len(self._pending)):
            pulse = self._pending.popleft()
            if not self._match(pulse, passive, host):
                self._pending.append(pulse)
        self.tracker.check_timeout(device)
        settled, self._settled = self._settled, self.tracker.settled
        if settled == self._settled or not self.enabled:
            return ''
        return 'stamps follow the sync pulses' if self._settled else \
            'sync pulses are missing: stamps follow the arrival of samples'

    def _match(self, pulse: int, passive: Estimate, host: HostClocks) -> bool:
        """Match a pulse with its ROS time; return False if that is not known yet."""
        raw = passive.host_time(pulse)
        estimated = host.to_ros_time(raw)
        reference = self.reference.find(estimated)
        if reference is None:
            return False
        true_raw = raw + reference - estimated
        if not EARLIEST < raw - true_raw < LATEST:
            self.tracker.spurious += 1
        elif self.tracker.feed(pulse, true_raw, passive.skew, passive.skew_deviation):
            self.delay.add(raw - true_raw)
        return True
