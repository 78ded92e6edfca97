# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Bags that hold `raw`: rosbag2 directories and their files, MCAP or SQLite.

A recorder that was killed leaves an MCAP file without its end, and perhaps no metadata.yaml. So
MCAP files are read from front to back, index and summary unused, as far as they go.
"""

from collections.abc import Iterator
from pathlib import Path
import re
import struct
from typing import Any, NamedTuple
import zlib

from bahrs_driver.recording.capture import Capture, Chunk
from bahrs_driver.recording.errors import CaptureError
from bahrs_driver.recording.origin import Origin, parse_label
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk as McapChunk, Message, Schema
from mcap.stream_reader import breakup_chunk, StreamReader
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import get_typestore, Stores
import zstandard

TYPE = 'std_msgs/msg/UInt8MultiArray'
NAME = 'raw'                # last part of the topic's name, if the user does not give one
# What the readers raise for bytes that are not what they should be.
_DAMAGE = (McapError, ReaderError, struct.error, zlib.error, zstandard.ZstdError, RuntimeError,
           ValueError, KeyError, UnicodeDecodeError)


class _Raw(NamedTuple):
    """A message of a topic that may be the one."""

    topic: str
    log_time: int
    data: bytes


class BagCapture(Capture):
    """The raw bytes in a bag."""

    timed = True

    def __init__(self, path: Path, topic: str | None) -> None:
        """Find the topic; CaptureError if there is none."""
        self._files = _files(path)
        super().__init__(path, sum(file.stat().st_size for file in self._files))
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._topic = topic
        self._others: set[str] = set()      # topics that could have been meant
        self._find()

    def chunks(self) -> Iterator[Chunk]:
        """Return all bytes in order; CaptureError if they cannot be read."""
        for message in self._messages():
            data, origin = self._decode(message)
            if origin:
                yield Chunk(data, origin.ros_ns, origin.raw_ns, origin.opening)
            else:
                yield Chunk(data, message.log_time)

    def _find(self) -> None:
        """Look at the first raw message."""
        first = next(self._messages(), None)
        if first is None and self._others:
            raise CaptureError(f'{self.path} has no topic {self._topic} of type {TYPE}, but '
                               f'{", ".join(sorted(self._others))}')
        if first is None and self.notes:
            raise CaptureError(self.notes[0])
        if first is None:
            name = f'topic {self._topic}' if self._topic else f'topic {NAME}'
            raise CaptureError(f'{self.path} has no {name} of type {TYPE}: record it with the '
                               'parameter publish.raw of the driver on')
        self._topic = first.topic
        _, origin = self._decode(first)
        if origin:
            self.sensor, self.byte_ns = origin.sensor, origin.byte_ns

    def _decode(self, message: _Raw) -> tuple[bytes, Origin | None]:
        decoded: Any = self._types.deserialize_cdr(message.data, TYPE)
        labels = [dimension.label for dimension in decoded.layout.dim]
        return decoded.data.tobytes(), parse_label(labels[0]) if labels else None

    def _messages(self) -> Iterator[_Raw]:
        self.done = 0
        self.notes.clear()
        for file in self._files:
            before = self.done
            read = _from_mcap if file.suffix == '.mcap' else _from_sqlite
            try:
                for message, done in read(file):
                    self.done = before + done
                    if self._is_wanted(message.topic):
                        yield message
            except OSError as error:
                raise CaptureError(f'cannot read {file}: {error.strerror}') from error
            except _DAMAGE as error:
                self.notes.append(f'{file} ends early or is damaged: what comes before that was '
                                  f'read ({error or type(error).__name__})')
            self.done = before + file.stat().st_size
        if self._others:
            self.notes.append(f'{self.path} has other topics of raw bytes, too, which were left '
                              f'out: {", ".join(sorted(self._others))}')

    def _is_wanted(self, topic: str) -> bool:
        named = topic.rpartition('/')[2] == NAME
        if self._topic is None:
            return named
        wanted = topic.strip('/') == self._topic.strip('/')
        if named and not wanted:
            self._others.add(topic)
        return wanted


def _files(path: Path) -> list[Path]:
    """Return the files of a bag in their order."""
    if not path.exists():
        raise CaptureError(f'cannot read {path}: there is no such file or directory')
    if path.is_file():
        return [path]
    for suffix in ('.mcap', '.db3'):
        found = sorted(path.glob(f'*{suffix}'), key=_number)
        if found:
            return found
    raise CaptureError(f'{path} is not a bag: it has no .mcap and no .db3 file')


def _number(file: Path) -> tuple[int, str]:
    """Return what orders files by the number that a split gave them."""
    digits = re.search(r'_(\d+)$', file.stem)
    return int(digits[1]) if digits else -1, file.name


def _from_mcap(file: Path) -> Iterator[tuple[_Raw, int]]:
    """Yield what may be raw messages, and how many bytes of the file are done."""
    topics: dict[int, str] = {}         # by channel
    schemas: set[int] = set()
    with file.open('rb') as stream:
        for record in StreamReader(stream, emit_chunks=True).records:
            items = breakup_chunk(record, validate_crc=True) \
                if isinstance(record, McapChunk) else [record]
            for item in items:
                if isinstance(item, Message):
                    if item.channel_id in topics:
                        yield (_Raw(topics[item.channel_id], item.log_time, item.data),
                               stream.tell())
                elif isinstance(item, Schema) and item.name == TYPE:
                    schemas.add(item.id)
                elif isinstance(item, Channel) and item.schema_id in schemas:
                    topics[item.id] = item.topic


def _from_sqlite(file: Path) -> Iterator[tuple[_Raw, int]]:
    """Yield what may be raw messages, and how many bytes of the file are done, about."""
    with Reader(file) as reader:
        size, begin, span = file.stat().st_size, reader.start_time, max(1, reader.duration)
        connections = [item for item in reader.connections if item.msgtype == TYPE]
        if not connections:
            return
        for connection, log_time, data in reader.messages(connections):
            yield _Raw(connection.topic, log_time, data), (log_time - begin) * size // span
