# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Arrival stamps, for comparison: the time of the read minus the transmission time.

They contain all delays of the adapter and the host.
"""

from collections.abc import Iterable

from bahrs_driver.clock.interface import Clock, Instant, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.clock.read_observer import ReadObserver
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.units import NS_PER_S

SET_BACK = NS_PER_S


class ArrivalClock(Clock):
    """
    Stamps each message with its arrival.

    Two chunks read in quick succession may put their frames in the wrong order; a stamp is
    therefore at least one nanosecond after the one before. Only if the host's clock was set back
    do stamps go back.
    """

    def __init__(self, fixed_latency: int = 0) -> None:
        """Subtract fixed_latency ns from each stamp."""
        self._fixed_latency = fixed_latency
        self._notices = Notices()
        self._reads = ReadObserver(self._notices)
        self.begin(0)

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""
        self._reads.begin(byte_time)
        self._byte_time = byte_time
        self._last = 0

    def observe_read(self, now: Instant, received: int) -> None:
        """Record the instant of a read, and the bytes of the stream received by then."""
        if self._reads.observe(now, received):
            self._last = 0

    def stamp(self, messages: Iterable[tuple[Message, Frame]]) -> list[Stamped]:
        """Stamp all messages with their arrival."""
        return [Stamped(message, frame, self._stamp_of(frame)) for message, frame in messages]

    def take_notices(self) -> list[str]:
        """Return the sentences for the user since the last call."""
        return self._notices.take()

    def state(self) -> TimeState:
        """Return the steps of the host's clock."""
        host = self._reads.host
        return TimeState('arrival', 'arrival', host_steps=host.steps,
                         last_host_step_s=host.last_step_ns / NS_PER_S)

    def _stamp_of(self, frame: Frame) -> int:
        reads = self._reads
        transmission = (reads.received - frame.offset) * self._byte_time
        stamp = reads.now.ros_ns - self._fixed_latency - transmission
        if self._last - SET_BACK < stamp <= self._last:
            stamp = self._last + 1
        self._last = stamp
        return stamp
