# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Collect the messages of a chunk of an MCAP file, and their index.

One `struct` packs what stands before the data of a message. The library `mcap` makes two objects
of each message and packs each field alone, which takes five times as long.
"""

from collections.abc import Iterable, Iterator, Mapping
import struct

from mcap.opcode import Opcode
import numpy as np

CHUNK_SIZE = 1 << 20        # bytes before compression, exceeded by the last message

# Log time in ns, topic, serialized data, publish time in ns.
MessageRecord = tuple[int, str, bytes, int]

_MESSAGE = struct.Struct('<BQHIQQ')     # opcode, size, channel, sequence, log and publish time
_INDEX = struct.Struct('<BQHI')         # opcode, size, channel, size of the entries
_UNCOUNTED = struct.calcsize('<BQ')     # opcode and size


class ChunkBuilder:
    """The records of one chunk."""

    def __init__(self) -> None:
        self.first = self.last = 0      # log times
        self.size = 0                   # bytes of the records
        self._records: list[bytes] = []
        # By topic: log time and offset of each message, in turn.
        self._entries: dict[str, list[int]] = {}

    @property
    def has_messages(self) -> bool:
        """Whether there is a message among the records."""
        return bool(self._entries)

    def add_record(self, record: bytes) -> None:
        """Append a record that is no message."""
        self._records.append(record)
        self.size += len(record)

    def fill(self, messages: Iterator[MessageRecord], channels: Mapping[str, int],
             counts: dict[str, int]) -> bool:
        """
        Append messages until the chunk is full; return whether it is.

        channels are the numbers of the channels by topic. counts, the messages of each topic in
        the file, are updated, and become the sequence numbers.
        """
        append, entries_by_topic, size = self._records.append, self._entries, self.size
        pack, opcode, fixed = _MESSAGE.pack, int(Opcode.MESSAGE), _MESSAGE.size
        log_time = self.last
        for log_time, topic, data, publish_time in messages:
            entries = entries_by_topic.get(topic)
            if entries is None:
                self.first = self.first if entries_by_topic else log_time
                entries = entries_by_topic[topic] = []
            entries.append(log_time)
            entries.append(size)
            count = counts[topic] = counts.get(topic, 0) + 1
            append(pack(opcode, fixed - _UNCOUNTED + len(data), channels[topic], count, log_time,
                        publish_time))
            append(data)
            size += fixed + len(data)
            if size > CHUNK_SIZE:
                break
        self.size, self.last = size, log_time
        return size > CHUNK_SIZE

    def data(self) -> bytes:
        """Return all records."""
        return b''.join(self._records)

    def indexes(self, channels: Mapping[str, int]) -> Iterable[tuple[int, bytes]]:
        """Yield the index of the messages of each channel, with the number of the channel."""
        for topic, entries in self._entries.items():
            data = np.array(entries, '<u8').tobytes()
            yield channels[topic], _INDEX.pack(
                Opcode.MESSAGE_INDEX, _INDEX.size - _UNCOUNTED + len(data), channels[topic],
                len(data)) + data
