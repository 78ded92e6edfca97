# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Message objects of ROS: make one of values, and compare its definition with a layout."""

from collections.abc import Iterator
from importlib import import_module
from operator import attrgetter
from typing import Any

from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.message_layout import Kind, MessageLayout, Row
from bahrs_driver.units import NS_PER_S


def to_message(values: Any) -> Any:
    """Return the message of values; an object that is a message already stays as it is."""
    layout = LAYOUTS.get(type(values))
    if layout is None:
        return values
    message = message_type(layout)()
    for row, value in zip(layout.rows, values):
        _set(message, row, value)
    return message


def message_type(layout: MessageLayout) -> Any:
    """Return the class of the messages with a layout."""
    package, _, name = layout.name.split('/')
    return getattr(import_module(f'{package}.msg'), name)


def matches(layout: MessageLayout) -> bool:
    """Return whether the definition that is installed has the fields of a layout."""
    return layout.fields == list(_definition('', message_type(layout)()))


def _set(message: Any, row: Row, value: Any) -> None:
    parent, _, name = row.path.rpartition('.')
    owner = attrgetter(parent)(message) if parent else message
    if row.kind is Kind.TIME:
        field = getattr(owner, name)
        field.sec, field.nanosec = divmod(value, NS_PER_S)
    elif row.members:
        field = getattr(owner, name)
        for member, number in zip(row.members, value):
            setattr(field, member, number)
    else:
        setattr(owner, name, value)


def _definition(prefix: str, message: Any) -> Iterator[tuple[str, str]]:
    for field, kind in message.get_fields_and_field_types().items():
        value = getattr(message, field)
        if hasattr(value, 'get_fields_and_field_types'):
            yield from _definition(f'{prefix}{field}.', value)
        else:
            yield prefix + field, kind
