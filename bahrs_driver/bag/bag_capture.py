# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read raw bytes from rosbag2 bags: directories or single files, MCAP or SQLite."""

from collections.abc import Iterator
from pathlib import Path

from bahrs_driver.bag.bag_files import BagFile, find_files
from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.compression import decompress_message
from bahrs_driver.bag.damage import MESSAGE
from bahrs_driver.bag.raw_message import read_raw
from bahrs_driver.bag.read_metadata import END_OF_TIME, parse_label, ReadMetadata
from bahrs_driver.bag.stored_message import LARGEST_PART, RAW_TOPIC, RAW_TYPE, StoredMessage
from bahrs_driver.errors import CaptureError, DamageError
from bahrs_driver.process.printable import printable


class BagCapture(Capture):
    """The raw bytes in a bag."""

    timed = True

    def __init__(self, path: Path, topic: str | None) -> None:
        """Open the topic, or that of any name `raw`; CaptureError if the bag has none."""
        self._files = [BagFile(file) for file in find_files(path)]
        super().__init__(path, sum(file.size for file in self._files))
        self._topic = topic
        self._others: set[str] = set()      # other topics of raw bytes
        self._read_first()

    def chunks(self) -> Iterator[Chunk]:
        """Yield all bytes in order; CaptureError if they cannot be read."""
        return (chunk for chunk, *_ in self._read())

    def _read_first(self) -> None:
        """Read the topic and the device from the first message that can be decoded."""
        first = next(self._read(), None)
        if first is None:
            raise CaptureError(self._why_empty())
        _, metadata, self._topic = first
        if metadata:
            self.sensor, self.byte_ns = metadata.sensor, metadata.byte_ns

    def _why_empty(self) -> str:
        damaged = next((file.damage for file in self._files if file.damage.count(MESSAGE)), None)
        shown = printable(self.path)
        wanted = f'topic {printable(self._topic or RAW_TOPIC)}'
        if damaged:
            return (f'{shown} has no message on {wanted} that can be decoded '
                    f'({damaged.reason(MESSAGE)}): record it with bahrs record or ros2 bag record')
        if self._topic and self._others:
            return f'{shown} has no {wanted} of type {RAW_TYPE}, but {_joined(self._others)}'
        if self.notes:
            return self.notes[0]
        return (f'{shown} has no {wanted} of type {RAW_TYPE}: record it with the parameter '
                'publish.raw of the driver on')

    def _read(self) -> Iterator[tuple[Chunk, ReadMetadata | None, str]]:
        """Yield the chunks with their metadata and topic."""
        self.done = 0
        self.notes.clear()
        for file in self._files:
            before = self.done
            for message in file.messages():
                self.done = before + file.done
                is_raw = message.topic.rpartition('/')[2] == RAW_TOPIC
                if is_raw if self._topic is None else _same(message.topic, self._topic):
                    with file.damage.skip_if_damaged(MESSAGE):
                        yield _decode(message)
                elif is_raw:
                    self._others.add(message.topic)
            self.done = before + file.size
            self.notes.extend(file.damage.sentences())
        if self._others:
            self.notes.append(f'{printable(self.path)} has other topics of raw bytes, too, which '
                              f'were left out: {_joined(self._others)}')


def _same(topic: str, other: str) -> bool:
    return topic.strip('/') == other.strip('/')


def _decode(message: StoredMessage) -> tuple[Chunk, ReadMetadata | None, str]:
    """Decode a message; raise any exception for a malformed one."""
    label, data = read_raw(decompress_message(message.data, LARGEST_PART))
    metadata = parse_label(label) if label else None
    if metadata:
        chunk = Chunk(data, metadata.ros_ns, metadata.raw_ns, metadata.connection_id)
        return chunk, metadata, message.topic
    if not 0 <= message.log_time < END_OF_TIME:
        raise DamageError('its time is before 1970 or after 2038')
    return Chunk(data, message.log_time), None, message.topic


def _joined(topics: set[str]) -> str:
    return printable(', '.join(sorted(topics)))
