# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Stamps for a device that answers requests and does not report the time of its samples.

The device measures after the last byte of the request has arrived and before the first byte of the
answer leaves. The stamp is the middle of the two; its error is at most half of the time between.
"""

from collections import deque
from collections.abc import Iterable
from statistics import median_low
from typing import Any

from bahrs_driver.clock.interface import Clock, Instant, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.clock.read_observer import ReadObserver
from bahrs_driver.clock.slewer import StampSlewer
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.units import NS_PER_S, NS_PER_US

ANSWERS = 99            # in the median of their uncertainty


class ExchangeClock(Clock):
    """
    Stamps answers with the middle of request and answer.

    A message is stamped by its `requested_at` (CLOCK_MONOTONIC_RAW, ns); if that is None, the
    stamp is the arrival. The stamp of a message that is not `expected` may precede earlier ones.
    """

    def __init__(self, request_size: int, fixed_latency: int = 0) -> None:
        """Assume requests of request_size bytes; subtract fixed_latency ns from each stamp."""
        self._request_size = request_size
        self._notices = Notices()
        self._reads = ReadObserver(self._notices)
        self._slewer = StampSlewer(self._reads.host, fixed_latency)
        self._halves: deque[int] = deque(maxlen=ANSWERS)
        self._arrivals = 0
        self.begin(0)

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""
        self._reads.begin(byte_time)
        self._request_duration = self._request_size * byte_time
        self._halves.clear()

    def observe_read(self, now: Instant, received: int) -> None:
        """Record the instant of a read, and the bytes of the stream received by then."""
        if self._reads.observe(now, received):
            self._slewer.allow_backward()

    def stamp(self, messages: Iterable[tuple[Message, Frame]]) -> list[Stamped]:
        """Stamp all messages."""
        return [Stamped(message, frame, self._stamp_of(message, frame))
                for message, frame in messages]

    def take_notices(self) -> list[str]:
        """Return the sentences for the user since the last call."""
        return self._notices.take()

    def state(self) -> TimeState:
        """Return the present state."""
        host = self._reads.host
        in_use = 'arrival' if self._arrivals and not self._halves else 'exchange'
        return TimeState(
            'exchange', in_use, settled=bool(self._halves),
            spread_us=median_low(self._halves) / NS_PER_US if self._halves else 0.0,
            arrival_stamps=self._arrivals, host_steps=host.steps,
            last_host_step_s=host.last_step_ns / NS_PER_S,
            median_chunk=self._reads.median_chunk)

    def _stamp_of(self, message: Any, frame: Frame) -> int:
        latest, requested_at = self._reads.bounds.bound(frame.offset), message.requested_at
        if not message.expected:
            return self._slewer.to_ros_time(latest)
        if requested_at is None:
            self._arrivals += 1
            return self._slewer.stamp_arrival(latest)
        earliest = requested_at + self._request_duration
        if latest < earliest:       # the line is faster than its baud rate
            earliest, latest = requested_at, self._reads.now.raw_ns
        self._halves.append((latest - earliest) // 2)
        return self._slewer.stamp_arrival((earliest + latest) // 2)
