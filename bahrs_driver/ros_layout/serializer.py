# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Serialize values for a publisher, which takes bytes as well as message objects."""

from collections.abc import Callable
from typing import Any

from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.message_objects import is_installed, matches, to_message


class Serializer:
    """
    Serializes values whose layout is that of the installed message definition.

    The others, if a version of ROS changes a definition, become message objects.
    """

    def __init__(self) -> None:
        installed = {kind: layout for kind, layout in LAYOUTS.items() if is_installed(layout)}
        layouts = {kind: layout for kind, layout in installed.items() if matches(layout)}
        self._serialize: dict[type, Callable[[Any], bytes]] = {
            kind: layout.serialize for kind, layout in layouts.items()}
        self._different = [layout.name for kind, layout in installed.items()
                           if kind not in layouts]

    def warnings(self) -> list[str]:
        """Return a sentence about definitions that differ, if any does."""
        return [f'{", ".join(self._different)}: the definition differs from that of ROS 2 Jazzy; '
                'publishing takes more processor time, and new fields keep their defaults'
                ] if self._different else []

    def serialize(self, values: object) -> Any:
        """Return the serialized message of values, or a message object."""
        serialize = self._serialize.get(type(values))
        return serialize(values) if serialize else to_message(values)
