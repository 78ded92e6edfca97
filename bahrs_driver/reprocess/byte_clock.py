# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a stream of bytes that was kept without times: every stamp is known beforehand."""

from collections.abc import Iterable
from typing import Any

from bahrs_driver.clock import Stamped, TimeState
from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.interface import Instant
from bahrs_driver.clock.slewer import StampSlewer
from bahrs_driver.protocol.bahrs.messages import (
    InertialTime, Navigation, NavigationTime, SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.reprocess.counted_stream import CountedStream
from bahrs_driver.units import NS_PER_MS, NS_PER_S, NS_PER_US

SAME = NS_PER_MS                # device times that differ by less are of one sample
FARTHEST = 10 * NS_PER_S        # that a message may speak of another time than that of samples


class ByteClock:
    """Stamps the messages of a stream whose samples were all looked at before."""

    def __init__(self, stream: CountedStream, fixed_latency: int) -> None:
        """Take the stream, and what to subtract from every stamp, in ns."""
        self._stream, self._times = stream, stream.times
        self._slewer = StampSlewer(HostClocks(), fixed_latency)
        self._jumps = stream.jumps()
        self._jump = next(self._jumps, None)
        self._received = 0              # samples
        before = stream.before or CountedSequence(-1, 0)
        self._latest = CountedSequence(stream.step * before.count, before.sequence)
        self._heard = False             # whether that sample itself was heard
        self._count = self._latest.count        # of the sample that was stamped last
        self._stamp = max(0, self._slewer.to_ros_time(self._times.ros_time(self._count)))

    def begin(self, byte_time: int) -> None:
        """Do nothing: there is one stream."""

    def observe_read(self, now: Instant, received: int) -> None:
        """Do nothing: no bytes were read at a time that tells anything."""

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Return the messages, each with its stamp, without those whose time cannot be."""
        stamped = ((message, frame, self._stamp_of(message)) for message, frame in messages)
        return [Stamped(message, frame, stamp) for message, frame, stamp in stamped
                if stamp is not None]

    def end(self) -> list[Stamped]:
        """Return nothing: no message waits."""
        return []

    def pulse_reference(self, ros_ns: int) -> None:
        """Do nothing: a recording has no external pulse times."""

    def take_notices(self) -> list[str]:
        """Return nothing: there is no clock that anybody could set."""
        return []

    def state(self) -> TimeState:
        """Return how stamps are made at present."""
        times = self._times
        stretch = times.stretch(self._latest.count)
        return TimeState(
            'device', 'device', label=self._stream.convention.label, settled=times.epochs > 0,
            offset_ns=stretch.offset, period_us=stretch.elapsed / stretch.samples / NS_PER_US,
            epochs=times.epochs, rejected_time_messages=times.rejected)

    def smoothing(self) -> None:
        """Return None: all samples were looked at before."""

    def _stamp_of(self, message: Any) -> int | None:
        stream, latest, kind = self._stream, self._latest, type(message)
        if kind is stream.kind:
            self._latest = self._next(message.sequence)
            self._received, self._heard = self._received + 1, True
            return self._sample(self._latest.count)
        stamp: int | None
        if kind is Navigation:
            count = stream.navigation.count(message.sequence, latest)
            if count is None or (count < latest.count and self._heard):
                count = latest.count        # it follows its sample, or one before that
            stamp = self._sample(count, again=True)
        elif kind is SyncPulseTime:
            stamp = self._point(message.device_time_us * NS_PER_US)
        elif kind in (InertialTime, NavigationTime) and message.valid:
            stamp = self._point(message.device_time_us * NS_PER_US, SAME)
        else:
            if kind is SoftwareVersion:     # the device was switched on: the next sample tells
                self._latest, self._heard = self._before_next(), False
            return self._stamp
        return None if stamp is None else self._slewer.in_order(kind, stamp)

    def _next(self, sequence: int) -> CountedSequence:
        """Return the next sample."""
        if self._jump and self._jump[0] == self._received:
            (_, found), self._jump = self._jump, next(self._jumps, None)
            return CountedSequence(self._stream.step * found.count, sequence)
        return CountedSequence(self._latest.count + self._stream.step, sequence)

    def _before_next(self) -> CountedSequence:
        """Return the sample before the next one, if counts do not go on by one there."""
        if self._jump and self._jump[0] == self._received:
            found = self._jump[1]
            return CountedSequence(self._stream.step * (found.count - 1), found.sequence - 1)
        return self._latest

    def _sample(self, count: int, again: bool = False) -> int:
        """Return the stamp of a sample, which may have been stamped already."""
        if not again or count != self._count:
            self._count = count
            self._stamp = self._slewer.stamp_arrival(self._times.ros_time(count))
        return self._stamp

    def _point(self, device: int, same: int = 0) -> int | None:
        """Return the stamp of a device time: that of the latest sample if it is the same."""
        stretch = self._times.stretch(self._latest.count)
        ahead = device - stretch.time_of(self._latest.count)
        if abs(ahead) < same:
            return self._stamp
        return self._slewer.to_ros_time(device + stretch.offset) if abs(ahead) < FARTHEST else None
