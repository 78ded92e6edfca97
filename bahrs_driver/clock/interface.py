# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of a clock, and the values that it takes and returns."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message


class Instant(NamedTuple):
    """One instant on both clocks of the host, in ns."""

    raw_ns: int         # CLOCK_MONOTONIC_RAW: never set or slewed
    ros_ns: int         # CLOCK_REALTIME, which is ROS time here


class Stamped(NamedTuple):
    """A message, its frame, and its time in ns since the epoch."""

    message: Message
    frame: Frame
    stamp_ns: int


@dataclass(frozen=True)
class TimeState:
    """The state of a clock, for diagnostics. Counts are since the start."""

    source: str                         # configured
    in_use: str                         # at present
    label: str = 'not seen yet'         # the sample that time messages name
    settled: bool = False
    held: int = 0                       # samples that wait for a stamp
    offset_ns: int | None = None        # ROS time minus device time
    skew_ppm: float = 0.0               # how much slower the device's clock is than the host's
    spread_us: float = 0.0              # of the smallest delays
    period_us: float | None = None
    epochs: int = 0
    rejected_samples: int = 0           # too late, or too early without confirmation
    rejected_time_messages: int = 0
    rejected_counters: int = 0
    arrival_stamps: int = 0             # samples stamped without device time
    dropped: int = 0                    # messages with an impossible time
    host_steps: int = 0
    last_host_step_s: float = 0.0
    pulses: int = 0
    pulses_spurious: int = 0
    pulses_missing: int = 0
    pulse_delay_us: float | None = None     # smallest delay, as measured by pulses
    median_chunk: int = 0               # bytes per read


class Clock(ABC):
    """
    Stamps messages. One thread uses it, except for `pulse_reference`.

    The defaults are those of a clock that holds no message and does not use the time of reads.
    """

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""

    def observe_read(self, now: Instant, received: int) -> None:
        """Record the instant of a read, and the bytes of the stream received by then."""

    @abstractmethod
    def stamp(self, messages: Iterable[tuple[Message, Frame]]) -> list[Stamped]:
        """Add the messages that the read completed; return all whose time is known."""

    def end(self) -> list[Stamped]:
        """End the stream; return the messages that still waited for a stamp."""
        return []

    def pulse_reference(self, ros_ns: int) -> None:
        """Add the ROS time of an external sync pulse. Any thread may call it."""

    def take_notices(self) -> list[str]:
        """Return the sentences for the user since the last call."""
        return []

    @abstractmethod
    def state(self) -> TimeState:
        """Return the present state."""

    def smoothing(self) -> 'Smoothing | None':
        """Return clocks for two passes over a recording, or None if one pass is as good."""
        return None


class Smoothing(NamedTuple):
    """Two passes over a recording: stamps of the second use the reads of all of it."""

    first_pass: Clock                       # it returns no messages
    second_pass: Callable[[], Clock]        # to call after the first pass
