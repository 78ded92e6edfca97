# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write metadata.yaml of a bag, in the format of rosbag2 in Jazzy (version 9)."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from bahrs_driver.bag.topics import definition, Topic
from bahrs_driver.files.atomic_file import write_atomic
import yaml

VERSION = 9
NAME = 'metadata.yaml'
NEVER = 2 ** 63 - 1             # start of a bag without messages


@dataclass
class FileInformation:
    """Messages in a file, counted by topic; times are log times in ns."""

    name: str = ''
    first: int = NEVER
    last: int = 0
    counts: dict[str, int] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Messages in the file."""
        return sum(self.counts.values())

    def times(self) -> dict[str, dict[str, int]]:
        """Return start and duration in the format of rosbag2."""
        return {'starting_time': {'nanoseconds_since_epoch': self.first},
                'duration': {'nanoseconds': max(0, self.last - self.first)}}


def write_metadata(folder: Path, topics: Iterable[Topic], files: list[FileInformation]) -> None:
    """Write the file, complete or not at all; WriteError if that is not possible."""
    text = as_yaml({'rosbag2_bagfile_information': information(topics, files)})
    write_atomic(folder / NAME, text.encode(), replace=True)


def as_yaml(data: object) -> str:
    """Return YAML without references."""
    text: str = yaml.dump(data, Dumper=_Dumper, sort_keys=False)
    return text


def information(topics: Iterable[Topic], files: list[FileInformation]) -> Mapping[str, object]:
    """Return the contents of metadata.yaml."""
    whole = FileInformation(
        first=min(file.first for file in files), last=max(file.last for file in files))
    return {
        'version': VERSION, 'storage_identifier': 'mcap', **whole.times(),
        'message_count': sum(file.count for file in files),
        'topics_with_message_count': [
            {'topic_metadata': {
                'name': topic.name, 'type': topic.type_name, 'serialization_format': 'cdr',
                'offered_qos_profiles': list(topic.qos),
                'type_description_hash': definition(topic.type_name)[1]},
             'message_count': sum(file.counts.get(topic.name, 0) for file in files)}
            for topic in topics],
        'compression_format': '', 'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [{'path': file.name, **file.times(), 'message_count': file.count}
                  for file in files],
        'custom_data': None, 'ros_distro': 'jazzy'}


class _Dumper(getattr(yaml, 'CSafeDumper', yaml.SafeDumper)):  # type: ignore[misc]
    """Writes no references, which the reader of rosbag2 may not support."""

    def ignore_aliases(self, _data: object) -> bool:
        """Return that nothing is written as a reference."""
        return True
