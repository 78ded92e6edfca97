# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write topics into a bag."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.topics import qos_profile, Topic
from bahrs_driver.reprocess.topic_writer import LoggedValues
from bahrs_driver.ros_layout.layouts import serialize, type_name

QUEUE_DEPTH = 100               # of a publisher that plays the bag


class BagTopicWriter:
    """Writes a rosbag2 directory. Relative names of topics are in a namespace."""

    def __init__(self, folder: Path, name: str, namespace: str = '') -> None:
        """Make a bag whose files have a name; WriteError if that is not possible."""
        self._bag = BagWriter(folder, name)
        self._prefix = f"/{namespace.strip('/')}/" if namespace.strip('/') else '/'
        self._names: dict[str, str] = {}        # absolute, by topic

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """Write names, types and quality of service of all topics."""
        volatile = qos_profile('keep_last', QUEUE_DEPTH, 'reliable', 'volatile')
        transient = qos_profile('keep_last', 1, 'reliable', 'transient_local')
        self._names = {topic: topic if topic.startswith('/') else self._prefix + topic
                       for topic in topics}
        self._bag.add_topics(
            Topic(self._names[topic], type_name(kind),
                  (transient if topic in latched else volatile,))
            for topic, kind in topics.items())

    def write(self, messages: Sequence[LoggedValues]) -> None:
        """Store messages in the order of their log times."""
        names = self._names
        self._bag.write((time_ns, names[topic], serialize(values), time_ns)
                        for time_ns, (topic, values) in messages)

    def close(self) -> None:
        """Complete the bag."""
        self._bag.close()
