# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Messages before they have a stamp, with what the clock knows of their time."""

from dataclasses import dataclass
from typing import Any, ClassVar

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.protocol.framing import Frame


@dataclass(slots=True, eq=False)
class HeldMessage:
    """A message; its time is `bound`, the latest raw time at which it was sent."""

    timed: ClassVar[bool] = False       # whether it has a time of its own

    message: Any
    frame: Frame
    bound: int


@dataclass(slots=True, eq=False)
class HeldSample(HeldMessage):
    """A sample; its time follows from its count."""

    timed: ClassVar[bool] = True

    count: int = 0
    plausible: bool = False             # its counter is
    feed_later: bool = False            # to the estimate, when its device time is known


@dataclass(slots=True, eq=False)
class HeldNavigation(HeldMessage):
    """A navigation message; its time is that of the sample it was computed from."""

    timed: ClassVar[bool] = True

    preceding: CountedSequence | None = None    # the sample before it, if there was one
    preceding_lost: bool = False                # that sample was not received


@dataclass(slots=True, eq=False)
class HeldTime(HeldMessage):
    """A time message or pulse; it contains a device time."""

    timed: ClassVar[bool] = True

    device_time: int | None = None      # ns; None before the first sample
