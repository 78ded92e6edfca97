# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Framing: find frames in a stream of bytes that may contain anything.

A frame is not trusted before its checksum passes, and is rejected by nothing but its checksum. So
the framer searches for the marker, asks the frame format which sizes the header allows, and takes
the first size whose checksum passes. A rejected candidate costs one byte, never its length: the
search continues one byte after its start, because the bytes that it claims may contain the next
intact frame. The framer waits for the rest of an incomplete candidate.

Devices send types that the formats do not know. Such a frame has no known size, and its candidate
is rejected like any other. When the next frame is found, and the bytes between the two end in a
valid checksum, they are counted as a frame of unknown type instead of skipped bytes.

The framer reports by return values and counters only. At any time

    bytes received = bytes of frames + bytes of unknown frames + skipped bytes + pending bytes
"""

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass, field
from enum import Enum
from typing import Final, NamedTuple, Protocol

from bahrs_driver.protocol.top_counter import TopCounter


class Frame(NamedTuple):
    """An intact frame: offset of its first byte in the stream, bytes, name of its checksum."""

    offset: int
    data: bytes
    checksum: str

    @property
    def end(self) -> int:
        """Return the offset of the first byte after the frame."""
        return self.offset + len(self.data)


_new_frame = tuple.__new__      # takes two thirds of the time of Frame()


class FrameFormat(Protocol):
    """Frame format of a device. `expected` has the kinds of outstanding answers, if known."""

    @property
    def marker(self) -> bytes:
        """Bytes at the start of every frame."""

    @property
    def header_size(self) -> int:
        """Count of bytes, including the marker, that determine the size of a frame."""

    def sizes(self, header: bytes, expected: Collection[type] | None, /) -> tuple[int, ...]:
        """Return the possible sizes of a frame with this header, ascending; none if unknown."""

    def passing_checksum(self, frame: bytes, expected: Collection[type] | None, /) -> str | None:
        """Return the name of the checksum that passes for these bytes."""

    def name_unknown(self, frame: bytes, /) -> str | None:
        """Return a name for these bytes if they are an intact frame of an unknown type."""


class _NoFrame(Enum):
    """Reason why there is no frame at a marker."""

    REJECTED = 'no frame begins here'
    INCOMPLETE = 'more bytes are needed'


_REJECTED: Final = _NoFrame.REJECTED
_INCOMPLETE: Final = _NoFrame.INCOMPLETE


@dataclass
class FramingCounters:
    """Contents of a stream so far."""

    frames: int = 0
    frame_bytes: int = 0
    crc_failures: int = 0
    skipped_bytes: int = 0
    unknown_bytes: int = 0
    unknown_types: TopCounter = field(default_factory=TopCounter)


class Framer:
    """
    Split a stream into intact frames.

    Chunks may have any size. After each call at most `max_gap` bytes plus one frame are pending.
    """

    def __init__(self, frame_format: FrameFormat, max_gap: int = 1024) -> None:
        """Recognize frames of unknown type up to max_gap bytes."""
        self.counters = FramingCounters()
        self._format = frame_format
        # These four are looked up for each frame.
        self._marker, self._header_size = frame_format.marker, frame_format.header_size
        self._sizes, self._passing_checksum = frame_format.sizes, frame_format.passing_checksum
        self._max_gap = max_gap
        self._expected: Collection[type] | None = None
        self._buffer = b''
        self._buffer_offset = 0         # of the first byte of the buffer, in the stream
        self._gap = 0                   # index of the first byte that is not counted yet
        self._search = 0                # index from which the next marker is searched
        # Indices in the gap at which a frame of unknown type may begin.
        self._unknown_candidates: deque[int] = deque()

    @property
    def received(self) -> int:
        """Count of bytes fed: the stream offset of the next byte."""
        return self._buffer_offset + len(self._buffer)

    @property
    def pending(self) -> int:
        """Count of bytes that are not assigned yet."""
        return len(self._buffer)

    def feed(self, data: bytes, expected: Collection[type] | None = None) -> list[Frame]:
        """
        Append bytes of the stream and return the frames that they complete.

        `expected` has the kinds of answers that are outstanding; None if that is not known.
        """
        self._expected = expected
        self._buffer = self._buffer + data if self._buffer else bytes(data)
        return self._take_frames(final=False)

    def skip_frames(self, count: int, size: int) -> None:
        """Count intact frames, `size` bytes in all, that were found without this framer."""
        assert not self._buffer, 'the bytes before them are pending'
        self.counters.frames += count
        self.counters.frame_bytes += size
        self._buffer_offset += size

    def flush(self) -> list[Frame]:
        """
        End the stream and return the frames inside an incomplete candidate.

        The remaining bytes are skipped; the next byte fed begins a new stream.
        """
        frames = self._take_frames(final=True)
        self._close_gap(len(self._buffer))
        self._drop(len(self._buffer))
        return frames

    def _take_frames(self, final: bool) -> list[Frame]:
        frames: list[Frame] = []
        size, buffer, marker, examine = 0, self._buffer, self._marker, self._examine
        while (start := buffer.find(marker, self._search)) >= 0:
            self._search = start
            found = examine(start, final)
            if found is _INCOMPLETE:
                break
            if found is _REJECTED:
                self._search = start + 1
                continue
            if start > self._gap:
                self._close_gap(start)
            end = self._gap = self._search = start + len(found.data)
            size += end - start
            frames.append(found)
        else:       # a partial marker may be at the end of the buffer
            self._search = max(self._search, len(buffer) - len(marker) + 1)
        self.counters.frames += len(frames)
        self.counters.frame_bytes += size
        self._drop_rejected()
        return frames

    def _examine(self, start: int, final: bool) -> Frame | _NoFrame:
        """Return the frame at a marker, or the reason why there is none."""
        buffer, expected = self._buffer, self._expected
        header_end = start + self._header_size
        if header_end > len(buffer) and not final:
            return _INCOMPLETE
        sizes = self._sizes(buffer[start:header_end], expected)
        for size in sizes:
            data = buffer[start:start + size]
            if len(data) < size:
                if not final:
                    return _INCOMPLETE
                break
            checksum = self._passing_checksum(data, expected)
            if checksum:
                return _new_frame(Frame, (self._buffer_offset + start, data, checksum))
        self._record_rejected(start, sizes)
        return _REJECTED

    def _record_rejected(self, start: int, sizes: tuple[int, ...]) -> None:
        """Count a CRC failure if the largest size was complete; without a size, keep the start."""
        self._close_unknown(start)
        if not sizes:
            self._unknown_candidates.append(start)
        elif start + sizes[-1] <= len(self._buffer):
            self.counters.crc_failures += 1

    def _close_gap(self, end: int) -> None:
        """Count the bytes of the gap, up to end, as unknown frames or skipped bytes."""
        self._close_unknown(end)
        self._unknown_candidates.clear()
        self.counters.skipped_bytes += end - self._gap
        self._gap = end

    def _close_unknown(self, end: int) -> None:
        """
        Count the frame of unknown type that ends here, if there is one.

        It begins at the first candidate if its payload contains markers, or at the last one if
        noise precedes it.
        """
        self._drop_candidates(end)
        candidates = self._unknown_candidates
        for start in sorted({candidates[0], candidates[-1]} if candidates else ()):
            name = self._format.name_unknown(self._buffer[start:end])
            if name:
                self.counters.unknown_types.add(name)
                self.counters.unknown_bytes += end - start
                self.counters.skipped_bytes += start - self._gap
                self._gap = end
                candidates.clear()
                return

    def _drop_candidates(self, position: int) -> None:
        """Drop the candidates that are more than max_gap before a position."""
        candidates = self._unknown_candidates
        while candidates and position - candidates[0] > self._max_gap:
            candidates.popleft()

    def _drop_rejected(self) -> None:
        """Drop the bytes that cannot be in a frame any more."""
        keep = self._search
        if self._unknown_candidates:
            self._drop_candidates(keep)
            keep = self._unknown_candidates[0] if self._unknown_candidates else keep
        self.counters.skipped_bytes += keep - self._gap
        self._gap = keep
        self._drop(keep)

    def _drop(self, count: int) -> None:
        if not count:
            return
        self._buffer = self._buffer[count:]
        self._buffer_offset += count
        self._search = max(0, self._search - count)
        self._gap = max(0, self._gap - count)
        if self._unknown_candidates:
            self._unknown_candidates = deque(index - count for index in self._unknown_candidates)
