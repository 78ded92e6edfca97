# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Stamps for a device that answers requests, and has no clock that it tells of its samples.

It measured after the last byte of the request had come and before the first byte of the answer
began to leave. The middle of the two is the stamp, and half of what lies between is the most that
it can be off.
"""

from collections import deque
from collections.abc import Iterable
from statistics import median_low
from typing import Any

from bahrs_driver.clock.bounds import ByteBounds
from bahrs_driver.clock.host import HostClocks, step_sentence
from bahrs_driver.clock.interface import Instant, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.clock.slewer import Output
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import NS_PER_S, NS_PER_US

REMEMBERED = 99         # answers, and reads


class ExchangeClock:
    """
    Stamps answers with the middle of request and answer.

    A message says by its `asked` when it was asked for (CLOCK_MONOTONIC_RAW, ns); one that does
    not gets the time of its arrival. One that is not `wanted` has no place in the order of time.
    """

    def __init__(self, request_size: int, fixed_latency: int = 0) -> None:
        """Take the bytes of a request, and what to subtract from every stamp, in ns."""
        self._request_size = request_size
        self._host = HostClocks()
        self._output = Output(self._host, fixed_latency)
        self._now = Instant(0, 0)
        self._received = 0
        self._halves: deque[int] = deque(maxlen=REMEMBERED)
        self._chunks: deque[int] = deque(maxlen=REMEMBERED)
        self._arrivals = 0
        self._notices = Notices()
        self.begin(0)

    def begin(self, byte_time: int) -> None:
        """Take note that another stream begins, and of the ns that a byte takes on its line."""
        self._bounds = ByteBounds(byte_time)
        self._request_time = self._request_size * byte_time
        self._halves.clear()

    def read(self, now: Instant, received: int) -> None:
        """Take the moment of a read, and how many bytes of the stream there are with it."""
        self._chunks.append(received - self._received)
        self._now, self._received = now, received
        self._bounds.read(now.raw_ns, received)
        step = self._host.read(now)
        if step < 0:
            self._output.allow_backward()
        if step:
            self._notices.add(step_sentence(step))

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Return all messages, each with its stamp."""
        return [Stamped(message, frame, self._stamp_of(message, frame))
                for message, frame in messages]

    def end(self) -> list[Stamped]:
        """Return nothing: no message waits."""
        return []

    def pulse_reference(self, ros_ns: int) -> None:
        """Do nothing: the device knows no pulses."""

    def take_notices(self) -> list[str]:
        """Return what the user should be told since the last call, a sentence each."""
        return self._notices.take()

    def state(self) -> TimeState:
        """Return how stamps are made at present."""
        in_use = 'arrival' if self._arrivals and not self._halves else 'exchange'
        return TimeState(
            'exchange', in_use, settled=bool(self._halves),
            spread_us=median_low(self._halves) / NS_PER_US if self._halves else 0.0,
            arrival_stamps=self._arrivals, host_steps=self._host.steps,
            last_host_step_s=self._host.last_step_ns / NS_PER_S,
            median_chunk=median_low(self._chunks) if self._chunks else 0)

    def _stamp_of(self, message: Any, frame: Frame) -> int:
        latest, asked = self._bounds.bound(frame.offset), message.asked
        if not message.wanted:
            return self._output.plain(latest)
        if asked is None:
            self._arrivals += 1
            return self._output.arrival(latest)
        earliest = asked + self._request_time
        if latest < earliest:       # the line is faster than it is said to be
            earliest, latest = asked, self._now.raw_ns
        self._halves.append((latest - earliest) // 2)
        return self._output.arrival((earliest + latest) // 2)
