# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read MCAP files from front to back, up to their end or damage.

A recorder that was killed leaves a file without its end, so index and summary are not needed. A
claimed length is never allocated: reads return the bytes that exist, up to a limit, and other
records are skipped.
"""

from collections.abc import Iterator
import contextlib
import io
import os
import struct
from typing import BinaryIO
import zlib

from bahrs_driver.bag.bag_kind import MCAP_MAGIC as MAGIC
from bahrs_driver.bag.compression import decompress
from bahrs_driver.bag.damage import Damage
from bahrs_driver.bag.stored_message import LARGEST_PART, RAW_TYPE, StoredMessage
from bahrs_driver.errors import DamageError
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema

_HEADER = struct.Struct('<BQ')          # of a record: its kind and its length
_MESSAGE = struct.Struct('<HIQQ')       # channel, sequence number, log time, publish time
_PIECE = 1 << 20
_DEFINITIONS = {Opcode.SCHEMA, Opcode.CHANNEL}
_USED = {*_DEFINITIONS, Opcode.MESSAGE, Opcode.CHUNK}

Record = tuple[int, bytes]


def read_mcap(stream: BinaryIO, damage: Damage) -> Iterator[StoredMessage]:
    """Yield the raw messages of a file in their order; DamageError if it ends too early."""
    if stream.read(len(MAGIC)) != MAGIC:
        raise DamageError('it is not an MCAP file')
    channels = _Channels(stream, damage)
    for record in _records(stream, damage, _USED):
        for kind, content in _expanded(record, damage):
            if kind == Opcode.MESSAGE and len(content) >= _MESSAGE.size:
                number, _, log_time, _ = _MESSAGE.unpack_from(content)
                topic = channels.topic(number)
                if topic is not None:
                    yield StoredMessage(topic, log_time, content[_MESSAGE.size:])
            elif kind in _DEFINITIONS:
                channels.add_definition(kind, content)
    if stream.read(len(MAGIC)) != MAGIC:
        raise DamageError('its end is missing')


class _Channels:
    """The topics of the channels that have raw messages."""

    def __init__(self, stream: BinaryIO, damage: Damage) -> None:
        self._stream = stream
        self._damage = damage
        self._schemas: set[int] = set()
        self._topics: dict[int, str | None] = {}    # by channel; None for another type
        self._summary_read = False

    def add_definition(self, kind: int, content: bytes) -> None:
        """Store a schema or a channel."""
        reader = ReadDataStream(io.BytesIO(content))
        with self._damage.skip_if_damaged('definition'):
            if kind == Opcode.CHANNEL:
                channel = Channel.read(reader)
                wanted = channel.schema_id in self._schemas
                self._topics[channel.id] = channel.topic if wanted else None
            else:
                schema = Schema.read(reader)
                if schema.name == RAW_TYPE:
                    self._schemas.add(schema.id)

    def topic(self, number: int) -> str | None:
        """Return the topic of a channel; None if its messages are of another type."""
        if number not in self._topics and not self._summary_read:
            self._read_summary()
        return self._topics.get(number)

    def _read_summary(self) -> None:
        """Read the definitions in the summary, which repeats those of damaged chunks."""
        self._summary_read = True
        if isinstance(self._stream, io.BufferedReader):     # a decompressed stream cannot
            position = self._stream.tell()
            self._stream.seek(len(MAGIC))
            with contextlib.suppress(Exception):        # later reads report the damage
                for kind, content in _records(self._stream, self._damage, _DEFINITIONS):
                    self.add_definition(kind, content)
            self._stream.seek(position)


def _expanded(record: Record, damage: Damage) -> Iterator[Record]:
    """Yield the records in a chunk, or the record itself."""
    kind, content = record
    if kind != Opcode.CHUNK:
        yield record
        return
    with damage.skip_if_damaged('chunk'):
        yield from _records_in_chunk(_decompressed(content))


def _decompressed(content: bytes) -> bytes:
    chunk = Chunk.read(ReadDataStream(io.BytesIO(content)))
    if chunk.uncompressed_size > LARGEST_PART:
        raise DamageError(f'it claims to expand to {chunk.uncompressed_size:,} bytes')
    data = decompress(chunk.compression, chunk.data, chunk.uncompressed_size)
    if chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise DamageError('its checksum is wrong')
    return data


def _records_in_chunk(content: bytes) -> Iterator[Record]:
    position = 0
    while position < len(content):
        kind, length = _HEADER.unpack_from(content, position)
        position += _HEADER.size
        if position + length > len(content):
            raise DamageError('a record in it is longer than the chunk')
        if kind in _USED:
            yield kind, content[position:position + length]
        position += length


def _records(stream: BinaryIO, damage: Damage, kinds: set[Opcode]) -> Iterator[Record]:
    """Yield records of some kinds up to the footer, and skip the others."""
    kind = 0
    while kind != Opcode.FOOTER:
        kind, length = _HEADER.unpack(_read_exactly(stream, _HEADER.size))
        if kind in kinds and length <= LARGEST_PART:
            yield kind, _read_exactly(stream, length)
            continue
        if kind in kinds:
            with damage.skip_if_damaged('record'):
                raise DamageError(f'it claims {length:,} bytes')
        stream.seek(length, os.SEEK_CUR)


def _read_exactly(stream: BinaryIO, length: int) -> bytes:
    """Read exactly length bytes, a piece at a time: only existing bytes are allocated."""
    pieces = []
    while length:
        piece = stream.read(min(length, _PIECE))
        if not piece:
            raise DamageError('it ends in the middle of a record')
        pieces.append(piece)
        length -= len(piece)
    return b''.join(pieces)
