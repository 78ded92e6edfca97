# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of rows and layouts, with messages of their own."""

from dataclasses import dataclass, replace
import math
from typing import Any

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.layout import (
    block,
    deviation,
    integer,
    integers,
    integrity_fields,
    Layout,
    scaled,
    text,
    valid_flags,
    vector,
    wire,
)
from hypothesis import given, strategies as st
import pytest
from support import independent


@dataclass(frozen=True, slots=True)
class Sample:
    """A message with a field of each kind."""

    count: int = wire(integer('B'))
    height: float = wire(scaled('H', 0.5, 'm', -10.0))
    force: Any = wire(vector('h', 0.25, 'N'))
    spread: Any = wire(deviation('H', 0.5, 'rad'))
    name: str = wire(text(3))
    data: bytes = wire(block(2))
    numbers: Any = wire(integers('I', 2))


@dataclass(frozen=True, slots=True)
class Changing:
    """A message whose fields change with the protocol version."""

    size: float = wire({1: scaled('h', 1.0, 'm'), 2: scaled('H', 1.0, 'm'),
                        4: scaled('B', 2.0, 'm')})
    health: Any = wire({1: valid_flags('B', 2), 3: integrity_fields('H', 2)})


SAMPLE = Sample(7, 20.5, (-0.25, 0.5, 0.0), 1.5, 'ab', b'\x00\xff', (1, 0x01020304))
PAYLOAD = bytes.fromhex('07' '3d00' 'ffff02000000' '0300' '616200' '00ff' '01000000' '04030201')


def changed(**values):
    """Return the sample with some values changed."""
    return replace(SAMPLE, **values)


def test_a_payload_decodes_field_by_field():
    """In the order of the dataclass, little-endian, without gaps."""
    assert Layout(Sample).decode(PAYLOAD) == SAMPLE


def test_a_message_encodes_field_by_field():
    """In the order of the dataclass, little-endian, without gaps."""
    assert Layout(Sample).encode(SAMPLE) == PAYLOAD


def test_the_size_is_that_of_the_payload():
    """Without alignment."""
    assert Layout(Sample).size == 24


def test_decoding_begins_at_start_and_ignores_later_bytes():
    """A payload is decoded inside its frame."""
    assert Layout(Sample).decode(b'header' + PAYLOAD + b'crc', 6) == SAMPLE


def test_raw_returns_the_numbers_on_the_wire():
    """Before any scaling."""
    assert Layout(Sample).raw(b'xx' + PAYLOAD, 2) == {
        'count': 7, 'height': 61, 'force': (-1, 2, 0), 'spread': 3, 'name': b'ab\0',
        'data': b'\x00\xff', 'numbers': (1, 0x01020304)}


def test_big_endian_reverses_the_bytes_of_each_number():
    """Strings and blocks do not change."""
    payload = bytes.fromhex(
        '07' '003d' 'ffff00020000' '0003' '616200' '00ff' '00000001' '01020304')
    layout = Layout(Sample, byte_order='>')
    assert layout.decode(payload) == SAMPLE
    assert layout.encode(SAMPLE) == payload


@pytest.mark.parametrize('version, payload, size, health', [
    (1, 'ffff01', -1.0, (1, 0)),
    (2, 'ffff02', 65535.0, (0, 1)),
    (3, 'ffff0600', 65535.0, (2, 1)),
    (4, 'ff0300', 510.0, (3, 0)),
    (9, 'ff0300', 510.0, (3, 0)),
])
def test_each_version_takes_the_latest_row_that_holds_for_it(version, payload, size, health):
    """A row is valid from its version to the next row."""
    message = Layout(Changing, version).decode(bytes.fromhex(payload))
    assert (message.size, message.health) == (size, tuple(map(Integrity, health)))


def test_a_row_can_be_replaced_by_name():
    """The other rows do not change."""
    layout = Layout(Sample, replace={'height': scaled('h', 0.5, 'm', -10.0),
                                     'no_such_field': integer('B')})
    assert layout.encode(changed(height=-12.0)) == PAYLOAD.replace(b'\x3d\x00', b'\xfc\xff')


def test_a_deviation_of_raw_zero_is_invalid():
    """Invalid is encoded as zero."""
    payload = PAYLOAD.replace(b'\x03\x00', b'\x00\x00', 1)
    assert Layout(Sample).decode(payload).spread is None
    assert Layout(Sample).encode(changed(spread=None)) == payload


@pytest.mark.parametrize('value', [0.01, 0.2, 0.249])
def test_a_small_deviation_does_not_become_invalid(value):
    """It is not rounded to zero."""
    layout = Layout(Sample)
    assert layout.decode(layout.encode(changed(spread=value))).spread is not None


@pytest.mark.parametrize('raw, value', [
    (b'\0\0\0', ''), (b'a\0\0', 'a'), (b'abc', 'abc'), (b'\xe9\0b', '\xe9\0b'),
    (b'\0\0c', '\0\0c')])
def test_text_drops_the_zero_bytes_at_its_end_only(raw, value):
    """Every byte is a character, so any content is valid."""
    payload = PAYLOAD.replace(b'ab\0', raw)
    assert Layout(Sample).decode(payload).name == value
    assert Layout(Sample).encode(changed(name=value)) == payload


@pytest.mark.parametrize('value, expected', [
    (20.24, 60), (20.26, 61), (20.74, 61), (20.76, 62), (-10.0, 0), (32757.5, 65535)])
def test_a_scaled_value_is_rounded_to_the_nearest(value, expected):
    """Truncation would cause a bias."""
    encoded = Layout(Sample).encode(changed(height=value))
    assert int.from_bytes(encoded[1:3], 'little') == expected


@pytest.mark.parametrize('name, value', [
    ('count', -1), ('count', 256),
    ('height', -10.3), ('height', 32757.8),
    ('height', math.nan), ('height', math.inf), ('height', -math.inf),
    ('force', (0.0, 8192.0, 0.0)), ('force', (0.0, 0.0, -8192.2)),
    ('force', (math.nan, 0.0, 0.0)), ('force', (0.0, 0.0)), ('force', (0.0, 0.0, 0.0, 0.0)),
    ('spread', -0.5), ('spread', 32768.0), ('spread', math.nan),
    ('name', 'abcd'), ('name', '\u0416'),
    ('data', b''), ('data', b'a'), ('data', b'abc'),
    ('numbers', (0, 2 ** 32)), ('numbers', (-1, 0)), ('numbers', (0,)), ('numbers', (0, 0, 0)),
])
def test_the_error_of_a_value_that_does_not_fit_names_its_field(name, value):
    """For every kind of row."""
    with pytest.raises(ValueError, match=f'^{name}: '):
        Layout(Sample).encode(changed(**{name: value}))


def test_the_error_of_a_value_that_does_not_fit_has_its_unit():
    """It shows a mistake of units."""
    with pytest.raises(ValueError, match='height: 40000.0 m '):
        Layout(Sample).encode(changed(height=40000.0))


@pytest.mark.parametrize('health', [(), (Integrity.SAFE,), (Integrity.SAFE,) * 3])
@pytest.mark.parametrize('version', [1, 3])
def test_a_health_of_the_wrong_length_is_refused(version, health):
    """It would set reserved bits, or omit signals."""
    with pytest.raises(ValueError, match='^health: '):
        Layout(Changing, version).encode(Changing(1.0, health))


@pytest.mark.parametrize('value', [0.5, 7.9])
def test_a_fraction_is_refused_for_an_integer(value):
    """Seconds instead of microseconds would be rounded to zero."""
    with pytest.raises((ValueError, TypeError)):
        Layout(Sample).encode(changed(count=value))


@independent.properties(200)
@given(st.binary(min_size=24, max_size=24))
def test_any_payload_decodes_and_encodes_back(payload):
    """No content of the right size raises an error or changes."""
    layout = Layout(Sample)
    assert layout.encode(layout.decode(payload)) == payload
