# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Arrival stamps, for comparison: the time of the read minus the transmission time.

They contain all delays of the adapter and the host.
"""

from collections.abc import Iterable
from typing import Any

from bahrs_driver.clock.host import HostClocks, step_sentence
from bahrs_driver.clock.interface import Instant, Stamped, TimeState
from bahrs_driver.clock.notices import Notices
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import NS_PER_S


class ArrivalClock:
    """
    Computes arrival stamps.

    Two chunks read in quick succession may put their frames in the wrong order; a stamp is
    therefore at least one nanosecond after the one before. Only if the host's clock was set back
    by more than a second do stamps go back.
    """

    _SET_BACK = NS_PER_S

    def __init__(self, byte_time: int) -> None:
        """Begin a stream on a line that transmits a byte in byte_time ns."""
        self._byte_time = byte_time
        self._last = 0

    def stamp(self, read_time: int, bytes_since: int) -> int:
        """
        Return the stamp of a frame, in ns since the epoch.

        read_time is the host's time at the read that completed the frame, bytes_since the number
        of bytes from the frame's first to the last of that read.
        """
        stamp = read_time - bytes_since * self._byte_time
        if self._last - self._SET_BACK < stamp <= self._last:
            stamp = self._last + 1
        self._last = stamp
        return stamp


class ArrivalStamps:
    """Stamps each message with its arrival; implements `Clock`."""

    def __init__(self, fixed_latency: int = 0) -> None:
        """Subtract fixed_latency ns from each stamp."""
        self._fixed_latency = fixed_latency
        self._host = HostClocks()
        self._notices = Notices()
        self._now = Instant(0, 0)
        self._received = 0
        self.begin(0)

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""
        self._byte_time = byte_time
        self._clock = ArrivalClock(byte_time)

    def observe_read(self, now: Instant, received: int) -> None:
        """Record the instant of a read, and the bytes of the stream received by then."""
        self._now = now
        self._received = received
        step = self._host.observe_read(now)
        if step:
            self._notices.add(step_sentence(step))
        if step < 0:                # followed at once
            self._clock = ArrivalClock(self._byte_time)

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Stamp all messages with their arrival."""
        time = self._now.ros_ns - self._fixed_latency
        return [Stamped(message, frame, self._clock.stamp(time, self._received - frame.offset))
                for message, frame in messages]

    def end(self) -> list[Stamped]:
        """Return an empty list: no message waits."""
        return []

    def pulse_reference(self, _ros_ns: int) -> None:
        """Ignore sync pulses."""

    def take_notices(self) -> list[str]:
        """Return the sentences for the user since the last call."""
        return self._notices.take()

    def state(self) -> TimeState:
        """Return the steps of the host's clock."""
        return TimeState('arrival', 'arrival', host_steps=self._host.steps,
                         last_host_step_s=self._host.last_step_ns / NS_PER_S)

    def smoothing(self) -> None:
        """Return None: no estimate is in use."""
