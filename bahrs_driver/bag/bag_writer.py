# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Write a rosbag2 directory with MCAP files.

The writer of `rosbags` buffers a megabyte, which is a minute and a half of raw bytes, and writes
metadata.yaml only at the end; a recorder that is killed would lose both. Here the caller closes
chunks at any time, the file is complete after each (see `crash_safe_file`), and metadata.yaml
exists from the beginning.
"""

from collections.abc import Callable, Iterable
import contextlib
from pathlib import Path
from types import TracebackType

from bahrs_driver.bag.crash_safe_file import CrashSafeFile
from bahrs_driver.bag.mcap_chunk import MessageRecord
from bahrs_driver.bag.mcap_output import McapOutput
from bahrs_driver.bag.metadata import as_yaml, FileInformation, write_metadata
from bahrs_driver.bag.topics import definition, Topic
from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import guard
from bahrs_driver.files.new_directory import make_directory
from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC


class BagWriter:
    """
    Writes messages, in the order of their log times.

    Once a method has raised WriteError, only close() may be called: all messages up to the last
    flush are in the bag.
    """

    def __init__(self, folder: str | Path, name: str = '') -> None:
        """
        Make the directory; WriteError if it exists or cannot be made.

        name is the beginning of the names of its files, if not that of the directory.
        """
        self.folder = Path(folder)
        with guard(folder):
            self._name = _file_name(name or self.folder.resolve().name)
        self._topics: dict[str, Topic] = {}
        self._files: list[FileInformation] = []
        self._broken = False
        make_directory(self.folder)
        try:
            self._begin_file()
        except WriteError:
            with contextlib.suppress(OSError):      # another program may have put files there
                self.folder.rmdir()
            raise

    @property
    def count(self) -> int:
        """Messages written so far."""
        return sum(file.count for file in self._files)

    @property
    def size(self) -> int:
        """Bytes in the present file."""
        return self._stream.tell()

    def files(self) -> list[str]:
        """Return the names of the files."""
        return [file.name for file in self._files]

    def counts(self) -> dict[str, int]:
        """Return the number of messages of each topic."""
        return {name: sum(file.counts.get(name, 0) for file in self._files)
                for name in self._topics}

    def add_topics(self, topics: Iterable[Topic]) -> None:
        """Add topics of later messages. Known topics stay as they are."""
        for topic in topics:
            if topic.name not in self._topics:
                self._topics[topic.name] = topic
                self._register(topic)
        self._write_metadata()

    def write(self, messages: Iterable[MessageRecord]) -> None:
        """Append messages of known topics; their log times must not decrease."""
        try:
            self._output.write(messages)
        except WriteError:
            self._broken = True
            raise

    def flush(self) -> None:
        """Write all messages into the file; WriteError if that is not possible."""
        self._guard(self._output.flush)

    def sync(self) -> None:
        """Make flushed messages survive a loss of power, and update metadata.yaml."""
        self._guard(self._stream.sync)
        self._write_metadata()

    def split(self) -> None:
        """Complete the file and begin the next."""
        self._end_file()
        self._begin_file()

    def close(self) -> None:
        """Complete the file and the bag; after an error, leave them as they are."""
        if not self._broken:
            self._end_file()
            self._write_metadata()
        self._stream.close()

    def __enter__(self) -> 'BagWriter':
        """Return the writer itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """Close the bag."""
        self.close()

    def _begin_file(self) -> None:
        name = f'{self._name}_{len(self._files)}.mcap'
        self._files.append(FileInformation(name))
        with guard(self.folder / name):
            self._stream = CrashSafeFile(self.folder / name, _trailer())
        self._output = McapOutput(self._stream, self._files[-1])
        for topic in self._topics.values():
            self._register(topic)
        self.flush()
        self._write_metadata()

    def _end_file(self) -> None:
        self._guard(self._output.finish)
        self._guard(self._stream.finish)

    def _register(self, topic: Topic) -> None:
        text, type_hash = definition(topic.type_name)
        self._output.add_topic(
            topic.name, topic.type_name, text,
            {'offered_qos_profiles': as_yaml(topic.qos), 'topic_type_hash': type_hash})

    def _write_metadata(self) -> None:
        self._guard(lambda: write_metadata(self.folder, self._topics.values(), self._files))

    def _guard(self, action: Callable[[], None]) -> None:
        try:
            with guard(self.folder):
                action()
        except WriteError:
            self._broken = True
            raise


def _file_name(folder_name: str) -> str:
    """Return a name for files, of printable characters: metadata.yaml is text."""
    return ''.join(character if character.isprintable() else '_'
                   for character in folder_name) or 'bag'


def _trailer() -> bytes:
    """Return the bytes that complete an MCAP file: an end without a summary."""
    builder = RecordBuilder()
    DataEnd(0).write(builder)
    Footer(0, 0, 0).write(builder)
    return bytes(builder.end()) + MCAP0_MAGIC  # type: ignore[no-untyped-call]
