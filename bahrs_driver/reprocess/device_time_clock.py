# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a stream without read times: a first pass has found the time of each sample."""

from collections.abc import Iterable, Iterator
from typing import Any

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.interface import Clock, Stamped, TimeState
from bahrs_driver.clock.slewer import StampSlewer
from bahrs_driver.clock.stamper import MAX_AGE, SAME_SAMPLE
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.reprocess.stream_counter import StreamCounter
from bahrs_driver.units import NS_PER_US


class DeviceTimeClock(Clock):
    """Stamps the messages of a stream that a first pass has examined."""

    def __init__(self, roles: MessageRoles, stream: StreamCounter,
                 jumps: Iterator[tuple[int, CountedSequence]], fixed_latency: int) -> None:
        """
        Stamp by the times of a stream; subtract fixed_latency ns from each stamp.

        jumps are the samples, numbered from 0, whose count does not follow from the one before.
        """
        self._roles, self._stream, self._times = roles, stream, stream.times
        self._slewer = StampSlewer(HostClocks(), fixed_latency)
        self._jumps = jumps
        self._jump = next(self._jumps, None)
        self._received = 0              # samples
        origin = stream.origin or CountedSequence(-1, 0)
        self._latest = CountedSequence(stream.step * origin.count, origin.sequence)
        self._latest_received = False   # whether it was received, or only sent
        self._count = self._latest.count        # of the latest sample with a stamp
        self._stamp = max(0, self._slewer.to_ros_time(self._times.ros_time(self._count)))

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Stamp the messages; drop those with an impossible time."""
        stamp_of = self._stamp_of
        return [Stamped(message, frame, stamp) for message, frame in messages
                if (stamp := stamp_of(message)) is not None]

    def state(self) -> TimeState:
        """Return the present state."""
        times = self._times
        segment = times.segment(self._latest.count)
        return TimeState(
            'device', 'device', label=self._stream.convention.label, settled=times.epochs > 0,
            offset_ns=segment.offset, period_us=segment.elapsed / segment.samples / NS_PER_US,
            epochs=times.epochs, rejected_time_messages=times.rejected)

    def _stamp_of(self, message: Any) -> int | None:
        stream, roles, kind = self._stream, self._roles, type(message)
        if kind is stream.kind:
            self._latest = self._next_sample(message.sequence)
            self._received, self._latest_received = self._received + 1, True
            return self._stamp_sample(self._latest.count)
        if kind is roles.power_on:
            self._latest, self._latest_received = self._sample_before_next(), False
        stamp: int | None
        if kind is roles.navigation:
            stamp = self._stamp_navigation(message.sequence)
        elif kind is roles.sync_pulse:
            stamp = self._stamp_time(message.device_time_us * NS_PER_US)
        elif kind in (roles.sample_time, roles.navigation_time) and message.valid:
            stamp = self._stamp_time(message.device_time_us * NS_PER_US, SAME_SAMPLE)
        else:
            return self._stamp
        return None if stamp is None else self._slewer.in_order(kind, stamp)

    def _next_sample(self, sequence: int) -> CountedSequence:
        """Return the count of the sample that has just arrived."""
        if self._jump and self._jump[0] == self._received:
            (_, sample), self._jump = self._jump, next(self._jumps, None)
            return sample
        return CountedSequence(self._latest.count + self._stream.step, sequence)

    def _sample_before_next(self) -> CountedSequence:
        """Return the sample before the next one, even if it was not received."""
        if self._jump and self._jump[0] == self._received:
            _, sample = self._jump
            return CountedSequence(sample.count - self._stream.step, sample.sequence - 1)
        return self._latest

    def _stamp_sample(self, count: int) -> int:
        self._count = count
        self._stamp = self._slewer.stamp_arrival(self._times.ros_time(count))
        return self._stamp

    def _stamp_navigation(self, sequence: int) -> int:
        """Return the stamp of the sample, which may have been stamped already."""
        latest = self._latest
        count = self._stream.navigation.count(sequence, latest)
        if count is None or (count < latest.count and self._latest_received):
            count = latest.count        # a navigation message follows its sample
        return self._stamp if count == self._count else self._stamp_sample(count)

    def _stamp_time(self, device: int, tolerance: int = 0) -> int | None:
        """Return the stamp of a device time: that of the latest sample within a tolerance."""
        segment = self._times.segment(self._latest.count)
        ahead = device - segment.time_of(self._latest.count)
        if abs(ahead) < tolerance:
            return self._stamp
        return self._slewer.to_ros_time(device + segment.offset) if abs(ahead) < MAX_AGE else None
