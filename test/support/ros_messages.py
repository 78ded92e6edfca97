# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Message objects of what converters return, and their types."""

from collections.abc import Iterable, Iterator, Mapping

from bahrs_driver.ros_layout.message_objects import message_type, to_message


def as_messages(outgoing: Iterable[tuple[str, object]]) -> Iterator[tuple[str, object]]:
    """Yield topics and message objects instead of values."""
    return ((topic, to_message(values)) for topic, values in outgoing)


def message_types(topics: Mapping[str, type]) -> dict[str, type]:
    """Return topics with the types of messages instead of those of values."""
    return {topic: message_type(kind) if issubclass(kind, tuple) else kind
            for topic, kind in topics.items()}
