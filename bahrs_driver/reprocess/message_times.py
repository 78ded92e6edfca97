# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time of each message of a BAHRS, while its stream is decoded.

Inertial and navigation messages have a counter, and time messages tie some of their counts to
device time. Between two that agree, time is straight. Between two that do not, the device was
started again, or much was lost, or one of them is wrong: the messages there have no time. So
messages are held until the next time message, a tenth of a second, and leave in their order. Only
a whole turn of a counter that is lost right before the first time message goes unnoticed.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.time_reference import TimeReferenceConvention
from bahrs_driver.protocol.bahrs.messages import Inertial, InertialTime, Navigation, NavigationTime
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import COUNTER_MODULUS

PERIODS = {Inertial: 5_000, Navigation: 10_000}     # us, nominal
ANCHORS = {InertialTime: Inertial, NavigationTime: Navigation}
TOLERANCE, JITTER = 0.03, 1_000     # of a period, and us, for two time messages to agree
MOST_HELD = 2000                    # messages; a device sends 330 a second
LAST, NONE = 2 ** 62, -1            # counts of no message


class Anchor(NamedTuple):
    """A message whose device time is known."""

    number: int         # its count
    time: int           # us


class Stretch(NamedTuple):
    """Counts up to one, and how their time goes; without an anchor it is not known."""

    end: int
    anchor: Anchor | None
    slope: float


class CounterTimes:
    """Counts the messages of one kind, and says when each was measured."""

    def __init__(self, period: int) -> None:
        self._period = period
        self._latest = CountedSequence(-1, -1)
        self._label = TimeReferenceConvention()
        self._last: Anchor | None = None
        self._slope: float | None = period      # up to the last anchor; None if none agreed
        self._connected = False
        self._first = 0                         # count from which on none is lost, to an anchor
        self._end = LAST                        # and before which none is lost, after one
        self._stretches: deque[Stretch] = deque()

    def add(self, sequence: int) -> int:
        """Count a message by its counter; return its count, or NONE if that is not clear."""
        before = self._latest
        ahead = (sequence - before.sequence) % COUNTER_MODULUS if before.count >= 0 else 1
        self._latest = CountedSequence(before.count + ahead, sequence)
        if ahead != 1:
            self._jumped(self._latest.count)
        return self._latest.count if ahead else NONE    # the same again, or a whole turn later

    def forget(self) -> None:
        """Forget the device time: the messages up to now have none."""
        self._stretches.append(Stretch(self._latest.count, None, 0.0))
        self._last, self._connected, self._slope = None, False, self._period
        self._first, self._end = self._latest.count + 1, LAST

    def anchor(self, reference: int, time: int) -> None:
        """Tie a device time in us to the message that it is about, by its counter."""
        if self._latest.count < 0:
            return
        named = self._latest.nearest(reference)
        self._label.vote(named - self._latest.count)
        now = Anchor(named - self._label.ahead, time)
        if self._last is None:
            self._last = now
        elif now.number > self._last.number:
            self._connect(self._last, now)
            self._last, self._end = now, LAST

    def time_of(self, count: int) -> int | None:
        """Return the device time of a message in us; None if it is not known."""
        if count == NONE:
            return None
        while self._stretches and self._stretches[0].end < count:
            self._stretches.popleft()       # counts are asked for in their order
        if not self._stretches:
            return None
        _, anchor, slope = self._stretches[0]
        time = anchor and round(anchor.time + (count - anchor.number) * slope)
        return time if time is not None and time >= 0 else None

    def decided(self, count: int) -> bool:
        """Return whether the time of a message is as well known as it will be."""
        return bool(self._stretches) and count <= self._stretches[-1].end

    def finish(self) -> None:
        """Go on from the last anchor to the end of the stream."""
        if self._last is None:
            return
        if not self._connected:
            self._stretches.append(Stretch(self._first - 1, None, 0.0))
        anchor = None if self._slope is None else self._last
        self._stretches.append(Stretch(self._end - 1, anchor, self._slope or 0.0))

    def _jumped(self, count: int) -> None:
        """Note a gap before a message: some were lost, or their counter began again."""
        if self._last is None:
            self._first = count
        else:
            self._end = min(self._end, count)

    def _connect(self, last: Anchor, now: Anchor) -> None:
        samples, elapsed = now.number - last.number, now.time - last.time
        nominal = samples * self._period
        agree = abs(elapsed - nominal) <= JITTER + TOLERANCE * nominal
        slope = elapsed / samples
        if not self._connected:         # what came before the first anchor
            self._stretches.append(Stretch(self._first - 1, None, 0.0))
            self._stretches.append(Stretch(last.number, last, slope if agree else self._period))
        self._connected, self._slope = True, slope if agree else None
        self._stretches.append(Stretch(now.number, last if agree else None, slope))


class PendingMessage(NamedTuple):
    """A message that waits for its time."""

    frame: Frame
    message: Any
    number: int         # its count


def with_times(messages: Iterable[tuple[Frame, Any]]
               ) -> Iterator[tuple[Frame, Any, int | None]]:
    """Yield the messages of a stream in their order, each with its device time in us or None."""
    counters = {kind: CounterTimes(period) for kind, period in PERIODS.items()}
    held: deque[PendingMessage] = deque()
    for frame, message in messages:
        kind = type(message)
        count = counters[kind].add(message.sequence) if kind in counters else 0
        if kind in ANCHORS:
            _tie(counters[ANCHORS[kind]], message)
        held.append(PendingMessage(frame, message, count))
        while held and (len(held) > MOST_HELD or _decided(counters, held[0])):
            yield _released(counters, held.popleft())
    for counter in counters.values():
        counter.finish()
    while held:
        yield _released(counters, held.popleft())


def _tie(counter: CounterTimes, message: InertialTime | NavigationTime) -> None:
    if message.valid:
        counter.anchor(message.reference_sequence, message.device_time_us)
    else:
        counter.forget()


def _decided(counters: dict[type[Any], CounterTimes], item: PendingMessage) -> bool:
    counter = counters.get(type(item.message))
    return counter is None or counter.decided(item.number)


def _released(counters: dict[type[Any], CounterTimes], item: PendingMessage
              ) -> tuple[Frame, Any, int | None]:
    frame, message, count = item
    counter = counters.get(type(message))
    if counter:
        return frame, message, counter.time_of(count)
    return frame, message, getattr(message, 'device_time_us', None) or None
