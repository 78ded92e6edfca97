# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a clock takes and gives, whatever it makes of it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from bahrs_driver.protocol.framing import Frame


class Instant(NamedTuple):
    """One moment on the host's two clocks, in ns."""

    raw_ns: int         # CLOCK_MONOTONIC_RAW: nobody sets or slews it
    ros_ns: int         # CLOCK_REALTIME, which is ROS time here


class Stamped(NamedTuple):
    """A message, the frame it came in, and its time in ns since the epoch."""

    message: Any
    frame: Frame
    stamp_ns: int


@dataclass(frozen=True)
class TimeState:
    """How stamps are made at present, for people to look at. Counts are since the start."""

    source: str                         # what was asked for
    in_use: str                         # what is in use
    label: str = 'not seen yet'         # the sample that time messages name
    settled: bool = False
    held: int = 0                       # samples that wait for a time
    offset_ns: int | None = None        # ROS time less device time
    skew_ppm: float = 0.0               # by how much device time runs slower than the host's
    spread_us: float = 0.0              # of the least delays
    period_us: float | None = None
    epochs: int = 0
    rejected_samples: int = 0           # too late, or too early without a witness
    rejected_time_messages: int = 0
    rejected_counters: int = 0
    arrival_stamps: int = 0             # samples stamped without device time
    dropped: int = 0                    # samples whose time cannot be
    host_steps: int = 0
    last_host_step_s: float = 0.0
    pulses: int = 0
    pulses_spurious: int = 0
    pulses_missing: int = 0
    pulse_delay_us: float | None = None     # what pulses say the least delay is
    median_chunk: int = 0               # bytes a read


class Clock(Protocol):
    """Gives messages their time. Called by one thread."""

    def begin(self, byte_time: int) -> None:
        """Take note that another stream begins, and of the ns that a byte takes on its line."""

    def read(self, now: Instant, received: int) -> None:
        """Take the moment of a read, and how many bytes of the stream there are with it."""

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Take the messages which that read completed, and return those whose time is known."""

    def end(self) -> list[Stamped]:
        """Take note that the stream has ended, and return what still waited for its time."""

    def pulse_reference(self, ros_ns: int) -> None:
        """Take the ROS time of a sync pulse from who knows it. May be called from any thread."""

    def take_notices(self) -> list[str]:
        """Return what the user should be told since the last call, a sentence each."""

    def state(self) -> TimeState:
        """Return how stamps are made at present."""
