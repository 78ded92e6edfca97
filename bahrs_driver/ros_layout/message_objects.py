# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Message objects of ROS: make one of values, and compare its definition with a layout."""

from array import array
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from operator import attrgetter
from typing import Any

from bahrs_driver.ros_layout.layouts import LAYOUTS, type_name
from bahrs_driver.ros_layout.message_layout import MessageLayout
from bahrs_driver.ros_layout.rows import Kind, Row
from bahrs_driver.units import NS_PER_S


def to_message(values: Any) -> Any:
    """Return the message object of values."""
    layout = LAYOUTS[type(values)]
    return _filled(layout.name, layout.rows, values)


def message_type(kind: type) -> Any:
    """Return the class of the message objects of a class of values."""
    return _message_class(type_name(kind))


def is_installed(layout: MessageLayout) -> bool:
    """Return whether the package of a message type is installed."""
    try:
        _message_class(layout.name)
    except ImportError:
        return False
    return True


def matches(layout: MessageLayout) -> bool:
    """Return whether the definition that is installed has the fields of a layout."""
    return layout.fields == list(_definition('', _message_class(layout.name)()))


@cache
def _message_class(name: str) -> Any:
    package, _, kind = name.split('/')
    return getattr(import_module(f'{package}.msg'), kind)


def _filled(name: str, rows: Iterable[Row], values: tuple[Any, ...]) -> Any:
    """Return a new message of a type with values."""
    message = _message_class(name)()
    for row, value in zip(rows, values):
        _set(message, row, value)
    return message


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
    elif row.kind is Kind.RECORDS:
        setattr(owner, name, [_filled(row.type_name, row.rows, record) for record in value])
    else:
        setattr(owner, name, array('B', value) if row.kind is Kind.DATA else value)


def _definition(prefix: str, message: Any) -> Iterator[tuple[str, str]]:
    for field, kind in message.get_fields_and_field_types().items():
        value = getattr(message, field)
        if hasattr(value, 'get_fields_and_field_types'):
            yield from _definition(f'{prefix}{field}.', value)
            continue
        yield prefix + field, kind
        if kind.startswith('sequence<') and '/' in kind:
            element = kind[len('sequence<'):-1].replace('/', '/msg/')
            yield from _definition(f'{prefix}{field}[].', _message_class(element)())
