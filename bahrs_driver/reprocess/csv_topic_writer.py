# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write each topic into a file of comma-separated values."""

from collections.abc import Iterator, Mapping, Sequence
import csv
import json
from pathlib import Path
from typing import Any

from bahrs_driver.files.live_file import LiveFile
from bahrs_driver.files.new_directory import make_directory
from bahrs_driver.reprocess.topic_writer import LoggedValues
from bahrs_driver.ros_layout.message_objects import message_type, to_message


class CsvTopicWriter:
    """Writes a directory with a file for each topic; columns are fields, times are in ns."""

    def __init__(self, folder: Path) -> None:
        """Make the directory; WriteError if it exists or cannot be made."""
        self._folder = folder
        self._files: list[LiveFile] = []
        self._writers: dict[str, Any] = {}
        make_directory(folder)

    def begin(self, topics: Mapping[str, type], _latched: set[str]) -> None:
        """Make the file of each topic with its head; WriteError if that is not possible."""
        for topic, kind in topics.items():
            path = self._folder / f"{topic.strip('/').replace('/', '_')}.csv"
            file = LiveFile(path)
            self._files.append(file)
            self._writers[topic] = csv.writer(file, lineterminator='\n')
            fields = _flat('', message_type(kind)())
            self._writers[topic].writerow(['time_ns', *(name for name, _ in fields)])

    def write(self, messages: Sequence[LoggedValues]) -> None:
        """Append a row for each message, with its log time; WriteError if there is no room."""
        for time_ns, (topic, values) in messages:
            fields = _flat('', to_message(values))
            self._writers[topic].writerow([time_ns, *(value for _, value in fields)])

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            file.close()


def _flat(prefix: str, message: Any) -> Iterator[tuple[str, object]]:
    """
    Yield name and value of each field.

    Names of nested fields are joined by dots, elements of fixed-size arrays are numbered, and a
    sequence is one JSON text.
    """
    for field, kind in message.get_fields_and_field_types().items():
        name, value = prefix + field, getattr(message, field)
        if kind.startswith('sequence<'):
            yield name, json.dumps(_plain(value))
        elif kind.endswith(']'):
            yield from ((f'{name}.{index}', item) for index, item in enumerate(value.tolist()))
        elif hasattr(value, 'get_fields_and_field_types'):
            yield from _flat(f'{name}.', value)
        else:
            yield name, value


def _plain(value: Any) -> Any:
    """Return a message or a sequence as JSON values."""
    if hasattr(value, 'get_fields_and_field_types'):
        return {name: _plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return list(value)
    if hasattr(value, 'tolist'):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, list) else value
