# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The certain device time of each message, while a stream is decoded.

Messages are held until the next time message, for a tenth of a second, and leave in their order.
A gap of 256 samples right before the first time message cannot be detected.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.reprocess.stream_counter import StreamCounter
from bahrs_driver.units import NS_PER_US

MOST_HELD = 2000                    # messages; a device sends 330 per second


class TimedMessage(NamedTuple):
    """A message with its frame and its device time in us, None if that is not certain."""

    frame: Frame
    message: Message
    device_time_us: int | None


class _Held(NamedTuple):
    """A message that waits for its time."""

    frame: Frame
    message: Message
    stream: StreamCounter | None    # that counts it; None for a message that is no sample
    sample: int | None              # its count; None without a plausible counter

    @property
    def is_final(self) -> bool:
        """Whether later messages cannot change its time."""
        return not self.stream or self.sample is None or self.stream.times.is_final(self.sample)

    def timed(self) -> TimedMessage:
        """Return the message with its device time."""
        if not self.stream:
            return TimedMessage(self.frame, self.message,
                                getattr(self.message, 'device_time_us', None) or None)
        time = None if self.sample is None else self.stream.times.certain_time(self.sample)
        if time is None or time < 0:
            return TimedMessage(self.frame, self.message, None)
        return TimedMessage(self.frame, self.message, round(time, -3) // NS_PER_US)


def with_device_time(messages: Iterable[tuple[Frame, Message]],
                     roles: MessageRoles | None) -> Iterator[TimedMessage]:
    """Yield the messages of a stream in their order, each with its device time in us or None."""
    if roles is None:
        yield from (TimedMessage(frame, message, None) for frame, message in messages)
        return
    samples, navigation = (StreamCounter(roles, kind, votes=0)
                           for kind in (roles.sample, roles.navigation))
    streams_of: dict[type[Message], tuple[StreamCounter, ...]] = {
        roles.sample: (samples,), roles.sample_time: (samples,),
        roles.navigation: (navigation,), roles.navigation_time: (navigation,),
        roles.power_on: (samples, navigation)}
    held = deque[_Held]()
    for frame, message in messages:
        held.append(_observe(frame, message, streams_of.get(type(message), ())))
        while held and (len(held) > MOST_HELD or held[0].is_final):
            yield held.popleft().timed()
    for stream in (samples, navigation):
        stream.times.end_stream()
    while held:
        yield held.popleft().timed()


def _observe(frame: Frame, message: Message, streams: Iterable[StreamCounter]) -> _Held:
    """Let the streams examine a message; return it with the one that counts it."""
    for stream in streams:
        before = stream.count
        stream.observe(type(message), message)
        if type(message) is stream.kind:
            return _Held(frame, message, stream, stream.count if stream.count > before else None)
        if not getattr(message, 'valid', True):
            stream.discard_times()
    return _Held(frame, message, None, None)
