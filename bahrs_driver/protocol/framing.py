# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Finding frames in a stream of bytes that may hold anything.

A frame cannot be trusted before its checksum has passed, and nothing but the checksum can be
trusted to reject it. So the framer looks for the marker, asks the frame format which sizes the
header allows, and takes the first size whose checksum passes. A candidate that fails costs its
marker, never its length: the search goes on one byte behind its start, because the bytes it
claimed may hold the next intact frame. A candidate that is not complete yet is waited for.

The formats of the devices know types that we do not. Such a frame has no known size. It too
costs only its marker; when the next frame has been found, and the bytes between turn out to end
in a valid checksum, they are counted as a frame of unknown type and not as skipped bytes.

What the framer knows is in its return values and its counters. At any time

    bytes received = bytes of frames + bytes of unknown frames + skipped bytes + pending bytes
"""

from collections import deque
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple, Protocol

from bahrs_driver.protocol.top_counter import TopCounter


class Frame(NamedTuple):
    """An intact frame: the offset of its first byte in the stream, its bytes, what vouches."""

    offset: int
    data: bytes
    checksum: str

    @property
    def end(self) -> int:
        """Offset of the first byte after the frame."""
        return self.offset + len(self.data)


class FrameFormat(Protocol):
    """What a framer must know of a device's frames."""

    @property
    def marker(self) -> bytes:
        """Bytes that every frame begins with."""

    @property
    def header_size(self) -> int:
        """Count of bytes, marker included, that tell the size of a frame."""

    def sizes(self, header: bytes) -> tuple[int, ...]:
        """Return the sizes that a frame with this header may have, ascending; none if unknown."""

    def passing_checksum(self, frame: bytes) -> str | None:
        """Return the name of the checksum that vouches for these bytes."""

    def name_unknown(self, frame: bytes) -> str | None:
        """Return what to call these bytes if they are an intact frame of a type not known."""


class _Verdict(Enum):
    """Why there is no frame at a marker."""

    REJECTED = 'no frame begins here'
    INCOMPLETE = 'more bytes are needed to tell'


@dataclass
class FramingCounters:
    """What a stream held so far."""

    frames: int = 0
    frame_bytes: int = 0
    crc_failures: int = 0
    skipped_bytes: int = 0
    unknown_bytes: int = 0
    unknown_types: TopCounter = field(default_factory=TopCounter)


class Framer:
    """
    Cuts a stream into intact frames.

    The stream may come in chunks of any size. After each call at most `longest_gap` bytes plus
    one frame are held back.
    """

    def __init__(self, frame_format: FrameFormat, longest_gap: int = 1024) -> None:
        """Start at offset 0. Unknown frames are recognised up to longest_gap bytes."""
        self.counters = FramingCounters()
        self._format = frame_format
        self._longest_gap = longest_gap
        self._buffer = bytearray()
        self._buffer_offset = 0         # of the first byte held, in the stream
        self._gap = 0                   # index of the first byte that belongs to no frame
        self._search = 0                # index from which the next marker is looked for
        self._strangers: deque[int] = deque()   # indices of candidates of unknown type in the gap

    @property
    def received(self) -> int:
        """How many bytes have been fed: the offset of the next byte to come."""
        return self._buffer_offset + len(self._buffer)

    @property
    def pending(self) -> int:
        """How many bytes are held back, undecided."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[Frame]:
        """Take the next bytes of the stream and return the frames that they complete."""
        self._buffer += data
        return self._take_frames(final=False)

    def flush(self) -> list[Frame]:
        """
        End the stream: return the frames that an incomplete candidate was hiding.

        The bytes that remain are skipped, so that the next byte fed starts afresh.
        """
        frames = self._take_frames(final=True)
        self._close_gap(len(self._buffer))
        self._drop(len(self._buffer))
        return frames

    def _take_frames(self, final: bool) -> list[Frame]:
        frames = []
        while (start := self._find_marker()) >= 0:
            found = self._examine(start, final)
            if isinstance(found, Frame):
                self._accept(start, found)
                frames.append(found)
            elif found is _Verdict.REJECTED:
                self._search = start + 1
            else:
                break
        self._drop_rejected()
        return frames

    def _find_marker(self) -> int:
        marker = self._format.marker
        start = self._buffer.find(marker, self._search)
        # Without one, its first bytes may still be the last that came.
        if start >= 0:
            self._search = start
        else:
            self._search = max(self._search, len(self._buffer) - len(marker) + 1)
        return start

    def _examine(self, start: int, final: bool) -> Frame | _Verdict:
        header_end = start + self._format.header_size
        if header_end > len(self._buffer) and not final:
            return _Verdict.INCOMPLETE
        sizes = self._format.sizes(bytes(self._buffer[start:header_end]))
        for size in sizes:
            data = bytes(self._buffer[start:start + size])
            if len(data) < size:
                if not final:
                    return _Verdict.INCOMPLETE
                break
            checksum = self._format.passing_checksum(data)
            if checksum:
                return Frame(self._buffer_offset + start, data, checksum)
        self._end_stranger(start)
        if not sizes:
            self._strangers.append(start)
        elif len(data) == size:
            self.counters.crc_failures += 1
        return _Verdict.REJECTED

    def _accept(self, start: int, frame: Frame) -> None:
        self._close_gap(start)
        self._gap = self._search = start + len(frame.data)
        self.counters.frames += 1
        self.counters.frame_bytes += len(frame.data)

    def _close_gap(self, end: int) -> None:
        """Account for the bytes from the gap's first to end, none of which is in a frame."""
        self._end_stranger(end)
        self._strangers.clear()
        self.counters.skipped_bytes += end - self._gap
        self._gap = end

    def _end_stranger(self, end: int) -> None:
        """
        Count the frame of unknown type that ends here, if one does.

        It began at the oldest candidate if its payload holds what looks like markers, at the
        latest if what came before it is noise.
        """
        self._forget_strangers(end)
        starts = {self._strangers[0], self._strangers[-1]} if self._strangers else set()
        for start in sorted(starts):
            name = self._format.name_unknown(bytes(self._buffer[start:end]))
            if name:
                self.counters.unknown_types.add(name)
                self.counters.unknown_bytes += end - start
                self.counters.skipped_bytes += start - self._gap
                self._gap = end
                self._strangers.clear()
                return

    def _forget_strangers(self, position: int) -> None:
        """Give up the candidates that lie too far before a position."""
        while self._strangers and position - self._strangers[0] > self._longest_gap:
            self._strangers.popleft()

    def _drop_rejected(self) -> None:
        """Let go of what can be in no frame any more."""
        self._forget_strangers(self._search)
        keep = self._strangers[0] if self._strangers else self._search
        self.counters.skipped_bytes += keep - self._gap
        self._gap = keep
        self._drop(keep)

    def _drop(self, count: int) -> None:
        del self._buffer[:count]
        self._buffer_offset += count
        self._search = max(0, self._search - count)
        self._gap = max(0, self._gap - count)
        if count:
            self._strangers = deque(index - count for index in self._strangers)
