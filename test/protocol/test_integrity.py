# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the integrity values and of their two encodings in health fields."""

from bahrs_driver.protocol.integrity import Integrity, two_bit_fields, valid_bits
from hypothesis import given, strategies as st
import pytest
from support import independent

SAFE, UNAVAILABLE = Integrity.SAFE, Integrity.UNAVAILABLE
RISK, RESERVED = Integrity.INTEGRITY_RISK, Integrity.RESERVED


@pytest.mark.parametrize('bits, label, available', [
    (0b00, 'unavailable', False),
    (0b01, 'safe', True),
    (0b10, 'integrity_risk', True),
    (0b11, 'reserved', False),
])
def test_each_bit_pattern_has_its_label_and_availability(bits, label, available):
    """As in section 2.4, and for the undefined pattern."""
    integrity = Integrity(bits)
    assert (integrity.label, integrity.available) == (label, available)


@pytest.mark.parametrize('word, health', [
    (0x0000, (UNAVAILABLE,) * 6),
    (0x0555, (SAFE,) * 6),
    (0x0001, (SAFE, *(UNAVAILABLE,) * 5)),
    (0x0800, (*(UNAVAILABLE,) * 5, RISK)),
    (0x00E4, (UNAVAILABLE, SAFE, RISK, RESERVED, UNAVAILABLE, UNAVAILABLE)),
])
def test_two_bit_fields_put_the_first_signal_lowest(word, health):
    """Section 3.1: bits 0 to 1 are specific force X, bits 10 to 11 angular rate Z."""
    decode, encode = two_bit_fields(6)
    assert decode(word) == health
    assert encode(health) == word


@pytest.mark.parametrize('bits, health', [
    (0b000000, (UNAVAILABLE,) * 6),
    (0b111111, (SAFE,) * 6),
    (0b000001, (SAFE, *(UNAVAILABLE,) * 5)),
    (0b100000, (*(UNAVAILABLE,) * 5, SAFE)),
])
def test_valid_bits_put_the_first_signal_lowest(bits, health):
    """Bit 0 is force X, bit 5 is rate Z; set is safe, cleared is unavailable."""
    decode, encode = valid_bits(6)
    assert decode(bits) == health
    assert encode(health) == bits


def test_reserved_bits_of_a_health_word_are_ignored():
    """Bits 10 to 15 of a word with five signals are reserved."""
    decode, _ = two_bit_fields(5)
    assert decode(0xFC01) == (SAFE, *(UNAVAILABLE,) * 4)


def test_reserved_bits_of_a_health_byte_are_ignored():
    """Bits 5 to 7 of a byte with five signals are reserved."""
    decode, _ = valid_bits(5)
    assert decode(0xE1) == (SAFE, *(UNAVAILABLE,) * 4)


@pytest.mark.parametrize('doubtful', [RISK, RESERVED])
def test_only_a_safe_signal_is_encoded_as_valid(doubtful):
    """One bit cannot express a risk, so it must not mean safe."""
    _, encode = valid_bits(3)
    assert encode((SAFE, doubtful, SAFE)) == 0b101


@independent.properties(200)
@given(st.integers(0, 0xFFFF))
def test_any_health_word_decodes_to_members(word):
    """No content raises."""
    decode, encode = two_bit_fields(6)
    health = decode(word)
    assert [type(integrity) for integrity in health] == [Integrity] * 6
    assert encode(health) == word & 0x0FFF


@independent.properties(200)
@given(st.integers(0, 0xFF))
def test_any_health_byte_decodes_to_members(bits):
    """No content raises."""
    decode, encode = valid_bits(6)
    health = decode(bits)
    assert [type(integrity) for integrity in health] == [Integrity] * 6
    assert encode(health) == bits & 0x3F
