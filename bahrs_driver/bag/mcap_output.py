# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write an MCAP file of ROS messages: compressed chunks with indexes, and a summary."""

from collections.abc import Iterable, Mapping
import struct
from typing import Protocol
import zlib

from bahrs_driver.bag.mcap_chunk import ChunkBuilder, MessageRecord
from bahrs_driver.bag.metadata import FileInformation
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel, Chunk, ChunkIndex, DataEnd, Footer, Header, McapRecord, Schema, Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC
import zstandard

PROFILE, LIBRARY = 'ros2', 'bahrs_driver'
COMPRESSION = 'zstd'

# What the checksum of the summary covers of the footer: opcode, size, the two offsets.
_FOOTER = struct.Struct('<BQQQ')
_FOOTER_SIZE = struct.calcsize('<QQI')


class Stream(Protocol):
    """A file to append to."""

    def write(self, data: bytes, /) -> int:
        """Append bytes."""

    def flush(self) -> None:
        """Write all bytes into the file."""

    def tell(self) -> int:
        """Return the offset of the next byte."""


class McapOutput:
    """
    Writes one file, and flushes the stream after every chunk.

    The information about the file is updated with every message.
    """

    def __init__(self, stream: Stream, information: FileInformation) -> None:
        """Write the beginning of the file."""
        self._stream = stream
        self._information = information
        self._schemas: dict[str, Schema] = {}
        self._channels: dict[str, Channel] = {}
        self._numbers: dict[str, int] = {}      # of channels, by topic
        self._chunk = ChunkBuilder()
        self._chunk_indexes = RecordBuilder()
        self._chunk_count = 0
        stream.write(MCAP0_MAGIC + _packed(Header(PROFILE, LIBRARY)))

    def add_topic(self, topic: str, type_name: str, definition: str,
                  metadata: Mapping[str, str]) -> None:
        """Add a topic with its type, the text that defines it, and metadata."""
        if type_name not in self._schemas:
            schema = self._schemas[type_name] = Schema(
                id=len(self._schemas) + 1, name=type_name,
                encoding='ros2msg' if definition else '', data=definition.encode())
            self._chunk.add_record(_packed(schema))
        self._numbers[topic] = len(self._channels) + 1
        channel = self._channels[topic] = Channel(
            id=self._numbers[topic], topic=topic, message_encoding='cdr',
            schema_id=self._schemas[type_name].id, metadata=dict(metadata))
        self._chunk.add_record(_packed(channel))

    def write(self, messages: Iterable[MessageRecord]) -> None:
        """Append messages, whose log times must not decrease."""
        remaining = iter(messages)
        while self._chunk.fill(remaining, self._numbers, self._information.counts):
            self.flush()
        self._update_times()

    def flush(self) -> None:
        """End the chunk, and flush the stream."""
        if self._chunk.has_messages:
            self._update_times()
            self._write_chunk()
            self._chunk = ChunkBuilder()
        self._stream.flush()

    def finish(self) -> None:
        """Write the end of the file; the stream is neither flushed nor closed."""
        if self._chunk.has_messages:
            self._write_chunk()
        self._stream.write(_packed(DataEnd(0)))
        start = self._stream.tell()
        summary = b''
        offsets = b''
        for opcode, records in self._summary():
            offsets += _packed(SummaryOffset(opcode, start + len(summary), len(records)))
            summary += records
        offset_start = start + len(summary)
        covered = summary + offsets + _FOOTER.pack(
            Opcode.FOOTER, _FOOTER_SIZE, start, offset_start)
        self._stream.write(summary + offsets + _packed(
            Footer(start, offset_start, zlib.crc32(covered))) + MCAP0_MAGIC)

    def _update_times(self) -> None:
        if self._chunk.has_messages:
            self._information.first = min(self._information.first, self._chunk.first)
            self._information.last = self._chunk.last

    def _write_chunk(self) -> None:
        """Write the chunk and the indexes of its messages, and add it to the summary."""
        stream, chunk, data = self._stream, self._chunk, self._chunk.data()
        start, compressed = stream.tell(), zstandard.compress(data)
        stream.write(_packed(Chunk(
            compression=COMPRESSION, data=compressed, message_start_time=chunk.first,
            message_end_time=chunk.last, uncompressed_crc=zlib.crc32(data),
            uncompressed_size=len(data))))
        indexes_start, offsets = stream.tell(), {}
        for number, index in chunk.indexes(self._numbers):
            offsets[number] = stream.tell()
            stream.write(index)
        ChunkIndex(
            message_start_time=chunk.first, message_end_time=chunk.last, chunk_start_offset=start,
            chunk_length=indexes_start - start, message_index_offsets=offsets,
            message_index_length=stream.tell() - indexes_start, compression=COMPRESSION,
            compressed_size=len(compressed), uncompressed_size=len(data)
        ).write(self._chunk_indexes)
        self._chunk_count += 1

    def _summary(self) -> Iterable[tuple[int, bytes]]:
        """Yield the groups of the summary: their opcode and their records."""
        counts = self._information.counts
        yield Opcode.SCHEMA, _packed(*self._schemas.values())
        yield Opcode.CHANNEL, _packed(*self._channels.values())
        yield Opcode.STATISTICS, _packed(Statistics(
            attachment_count=0, metadata_count=0, schema_count=len(self._schemas),
            channel_count=len(self._channels), chunk_count=self._chunk_count,
            channel_message_counts={self._numbers[topic]: count
                                    for topic, count in counts.items()},
            message_count=sum(counts.values()),
            message_start_time=self._information.first if counts else 0,
            message_end_time=self._information.last))
        yield Opcode.CHUNK_INDEX, _taken(self._chunk_indexes)
        yield Opcode.ATTACHMENT_INDEX, b''
        yield Opcode.METADATA_INDEX, b''


def _packed(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return _taken(builder)


def _taken(builder: RecordBuilder) -> bytes:
    return bytes(builder.end())  # type: ignore[no-untyped-call]
