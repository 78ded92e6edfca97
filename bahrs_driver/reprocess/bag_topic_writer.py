# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write topics into a bag."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.topics import qos_profile, Topic
from bahrs_driver.convert.outgoing import Values
from bahrs_driver.reprocess.topic_writer import LoggedValues
from bahrs_driver.ros_layout.layouts import LAYOUTS

QUEUE_DEPTH = 100               # of a publisher that plays the bag


class BagTopicWriter:
    """Writes a rosbag2 directory. Relative names of topics are in a namespace."""

    def __init__(self, folder: Path, name: str, namespace: str = '') -> None:
        """Make a bag whose files have a name; WriteError if that is not possible."""
        self._bag = BagWriter(folder, name)
        self._prefix = f"/{namespace.strip('/')}/" if namespace.strip('/') else '/'
        # By topic: its absolute name, and the function that serializes its values.
        self._topics: dict[str, tuple[str, Callable[[Values], bytes]]] = {}

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """Write names, types and quality of service of all topics."""
        volatile = qos_profile('keep_last', QUEUE_DEPTH, 'reliable', 'volatile')
        transient = qos_profile('keep_last', 1, 'reliable', 'transient_local')
        for topic, kind in topics.items():
            name = topic if topic.startswith('/') else self._prefix + topic
            self._topics[topic] = name, LAYOUTS[kind].serialize
        self._bag.add_topics(
            Topic(self._topics[topic][0], LAYOUTS[kind].name,
                  (transient if topic in latched else volatile,))
            for topic, kind in topics.items())

    def prepare(self, messages: Iterable[LoggedValues]) -> list[tuple[int, tuple[str, bytes]]]:
        """Serialize messages: they wait in less memory, and are still in the processor's cache."""
        topics, prepared = self._topics, []
        for time_ns, (topic, values) in messages:
            name, serialize = topics[topic]
            prepared.append((time_ns, (name, serialize(values))))
        return prepared

    def write(self, messages: Sequence[tuple[int, tuple[str, bytes]]]) -> None:
        """Store prepared messages in the order of their log times."""
        self._bag.write((time_ns, name, data, time_ns) for time_ns, (name, data) in messages)

    def close(self) -> None:
        """Complete the bag."""
        self._bag.close()
