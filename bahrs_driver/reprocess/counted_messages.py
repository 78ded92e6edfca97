# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find the messages of a capture that count its samples and give them a time.

Frames are found in blocks. Nearly all messages are samples and navigation messages: only their
counters are decoded.
"""

from collections.abc import Iterable, Iterator
from itertools import repeat
from operator import itemgetter
from typing import Any, NamedTuple

from bahrs_driver.devices.recording_format import RecordingFormat
from bahrs_driver.protocol.batch import block_column
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import Frame


class Counter(NamedTuple):
    """What is decoded of a sample or a navigation message."""

    sequence: int


# A message of a stream: offset of its frame, type, and the message or only its Counter.
CountedMessage = tuple[int, type[Any], Any]


_offset = itemgetter(0)


class CountedMessages:
    """Decodes the messages with a role in a stream."""

    def __init__(self, recording_format: RecordingFormat) -> None:
        roles = recording_format.roles
        self._framer = BlockFramer(recording_format.frame_format)
        self._header_size = recording_format.frame_format.header_size
        counted = {roles.sample, roles.navigation}
        used = counted | {roles.sample_time, roles.navigation_time, roles.power_on}
        self._counted = {header: layout for header, layout in recording_format.layouts.items()
                         if layout.message in counted}
        self._used = {header: layout for header, layout in recording_format.layouts.items()
                      if layout.message in used}

    def feed(self, data: bytes) -> Iterator[CountedMessage]:
        """Yield the messages that a block completes, in their order."""
        run: list[CountedMessage] = []
        for found in self._framer.feed(data):
            if isinstance(found, FrameBlock):
                run += self._of_block(found)
            else:
                yield from sorted(run, key=_offset)
                run.clear()
                yield from self._of_frames(found)
        yield from sorted(run, key=_offset)

    def flush(self) -> Iterator[CountedMessage]:
        """Yield the messages at the end of the stream."""
        return self._of_frames(self._framer.flush())

    def _of_block(self, block: FrameBlock) -> Iterable[CountedMessage]:
        header, offsets, rows = block
        layout = self._used.get(header)
        if layout is None:
            return ()
        messages: Iterable[Any]
        if header in self._counted:
            messages = map(Counter, block_column(layout, block, 'sequence').tolist())
        else:
            messages = [layout.decode(row.tobytes(), self._header_size) for row in rows]
        return zip(offsets.tolist(), repeat(layout.message), messages)

    def _of_frames(self, frames: Iterable[Frame]) -> Iterator[CountedMessage]:
        for offset, data, _ in frames:
            layout = self._used.get(data[:self._header_size])
            if layout:
                yield offset, layout.message, layout.decode(data, self._header_size)
