# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compile the rows of a layout into one function that decodes and one that encodes.

Calls for each field would take most of the time of a message. So both functions are written as
source code with one line for each field, as `dataclasses` writes constructors. For a message of a
counter and a vector:

    def decode(payload, start=0):
        raw0, raw1, raw2, raw3, = unpack(payload, start)
        message = Writable()
        message.sequence = raw0
        message.force = (raw1 * 0.0014964, raw2 * 0.0014964, raw3 * 0.0014964,)
        message.__class__ = Kind
        return message

Messages are frozen, and their constructors set each field on a slow way around that. A Writable
is of a subclass that is not frozen and has no other fields, so it can become a message.
"""

from collections.abc import Callable, Sequence
import struct
from typing import Any, NamedTuple, TypeVar

from bahrs_driver.protocol.row import Row

Message = TypeVar('Message')


class _Field(NamedTuple):
    """A field, and the variables of its raw numbers."""

    name: str
    row: Row
    raws: list[str]


def compile_decoder(kind: type[Message], rows: Sequence[tuple[str, Row]],
                    packer: struct.Struct) -> Callable[..., Message]:
    """Return a function of bytes, and of the place at which the payload starts (0)."""
    assert not hasattr(kind, '__post_init__'), 'no constructor is called'
    fields = _fields(rows)
    return _compile('decode(payload, start=0)', [
        f"{''.join(raw + ', ' for field in fields for raw in field.raws)}= unpack(payload, start)"
        if fields else '',
        'message = Writable()',
        *(f'message.{field.name} = {_value(field)}' for field in fields),
        'message.__class__ = Kind',
        'return message',
    ], {'unpack': packer.unpack_from, 'Kind': kind, 'Writable': _writable(kind),
        **{f'decode_{name}': row.decode for name, row in rows}})


def compile_encoder(rows: Sequence[tuple[str, Row]],
                    packer: struct.Struct) -> Callable[[Any], bytes]:
    """Return a function of a message. It raises the errors of conversions and of struct."""
    fields = _fields(rows)
    return _compile('encode(message)', [
        *(f"{', '.join(field.raws)}{',' * (field.row.count > 1)} = message.{field.name}"
          for field in fields),
        f"return pack({', '.join(_raw(field, raw) for field in fields for raw in field.raws)})",
    ], {'pack': packer.pack, **{f'encode_{name}': row.encode for name, row in rows}})


def _fields(rows: Sequence[tuple[str, Row]]) -> list[_Field]:
    fields, count = [], 0
    for name, row in rows:
        fields.append(_Field(name, row, [f'raw{count + index}' for index in range(row.count)]))
        count += row.count
    return fields


def _value(field: _Field) -> str:
    """Return the source of the value of a field."""
    name, row, raws = field
    if row.decode:
        return f"decode_{name}({', '.join(raws)})"
    if row.scale is not None:
        offset = f' + {row.offset!r}' if row.offset else ''
        raws = [f'{raw} * {row.scale!r}{offset}' for raw in raws]
    return f"({', '.join(raws)},)" if row.count > 1 else raws[0]


def _raw(field: _Field, value: str) -> str:
    """Return the source of a raw number of a field; value is the variable with the value."""
    name, row, _ = field
    if row.encode:
        return f'encode_{name}({value})'
    if row.scale is not None:
        shifted = f'({value} - {row.offset!r})' if row.offset else value
        return f'round({shifted} / {row.scale!r})'
    return value


def _writable(kind: type[Any]) -> type[Any]:
    """Return a subclass whose instances can be changed."""
    plain = {name: getattr(object, name) for name in ('__init__', '__setattr__', '__delattr__')}
    return type(f'Writable{kind.__name__}', (kind,), {'__slots__': (), **plain})


def _compile(signature: str, lines: Sequence[str], names: dict[str, Any]) -> Callable[..., Any]:
    """Return the function with this signature and body, in which names are known."""
    source = f'def {signature}:\n' + ''.join(f'    {line}\n' for line in lines)
    exec(source, names)
    function: Callable[..., Any] = names[signature.partition('(')[0]]
    return function
