# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Message objects of what converters return."""

from collections.abc import Iterable, Iterator

from bahrs_driver.ros_layout.message_objects import to_message


def as_messages(outgoing: Iterable[tuple[str, object]]) -> Iterator[tuple[str, object]]:
    """Yield topics and message objects instead of values."""
    return ((topic, to_message(values)) for topic, values in outgoing)
