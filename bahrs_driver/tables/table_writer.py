# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a table for each topic, a block of rows at a time."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

from bahrs_driver.convert.outgoing import Values
from bahrs_driver.tables.row_buffer import Block, RowBuffer

_Logged = tuple[int, tuple[str, Values]]


class Sink(Protocol):
    """Receives the blocks of one table."""

    def write(self, block: Block) -> None:
        """Append rows."""

    def close(self) -> None:
        """Complete the table."""


class TableWriter:
    """
    Collects the messages of each topic and passes them to a sink in blocks.

    open_sink is called with the name of each topic and the class of its values. Topics in
    `without` are left out.
    """

    def __init__(self, open_sink: Callable[[str, type], Sink],
                 without: frozenset[str] = frozenset()) -> None:
        self._open_sink = open_sink
        self._without = without
        self._tables: dict[str, tuple[RowBuffer, Sink]] = {}

    def begin(self, topics: Mapping[str, type], _latched: set[str]) -> None:
        """Open the sink of each topic."""
        for topic, kind in topics.items():
            if topic not in self._without:
                self._tables[topic] = RowBuffer(kind), self._open_sink(topic, kind)

    def prepare(self, messages: Iterable[_Logged]) -> Iterable[_Logged]:
        """Return messages as they are."""
        return messages

    def write(self, messages: Iterable[_Logged]) -> None:
        """Append values to the tables of their topics; messages begin with their log times."""
        by_topic = defaultdict(list)
        for time_ns, (topic, values) in messages:
            by_topic[topic].append((time_ns, values))
        for topic, rows in by_topic.items():
            if topic in self._tables:
                buffer, sink = self._tables[topic]
                buffer.extend(rows)
                if buffer.is_full:
                    sink.write(buffer.take())

    def close(self) -> None:
        """Pass the last rows on, and close the sinks."""
        for buffer, sink in self._tables.values():
            if not buffer.is_empty:
                sink.write(buffer.take())
            sink.close()
