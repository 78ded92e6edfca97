# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the three checksums against their published check values and bitwise twins."""

from bahrs_driver.protocol.bahrs import checksum
from hypothesis import given, strategies as st
import pytest
from support import independent

CHECK = b'123456789'
FIRST_FRAME = bytes.fromhex('4e45020001 00 d5ffe2ff8ae6 fcff02000700 3f 00 f65b0c0a')
WHOLE_WORDS = st.integers(0, 20).flatmap(lambda n: st.binary(min_size=4 * n, max_size=4 * n))


def test_mpeg2_returns_the_check_value_of_the_document():
    """Section 2.2: check = 0x0376E6E7."""
    assert checksum.mpeg2(CHECK) == bytes.fromhex('e7e67603')


def test_crc32_gives_the_published_check_value():
    """The check value of the ordinary CRC-32 is 0xCBF43926."""
    assert checksum.crc32(CHECK) == bytes.fromhex('2639f4cb')


def test_mpeg2_words_reverses_each_group_of_four():
    """0x49E3C2FB is the CRC over bytes of b'12345678'."""
    assert checksum.mpeg2_words(b'43218765') == bytes.fromhex('fbc2e349')


def test_mpeg2_words_fits_the_first_frame_of_the_recording():
    """The device computes its CRC over words."""
    assert checksum.mpeg2_words(FIRST_FRAME[:-4]) == FIRST_FRAME[-4:]


def test_mpeg2_over_bytes_does_not_fit_the_first_frame_of_the_recording():
    """The two orders differ."""
    assert checksum.mpeg2(FIRST_FRAME[:-4]) != FIRST_FRAME[-4:]


@pytest.mark.parametrize('checksum, value', [
    (checksum.mpeg2, 'ffffffff'), (checksum.mpeg2_words, 'ffffffff'),
    (checksum.crc32, '00000000')])
def test_no_data_gives_the_initial_value(checksum, value):
    """Only the output XOR changes the register."""
    assert checksum(b'') == bytes.fromhex(value)


@pytest.mark.parametrize('size', [1, 2, 3, 5, 23])
def test_mpeg2_words_rejects_part_of_a_word(size):
    """A CRC over words requires whole words."""
    with pytest.raises(ValueError):
        checksum.mpeg2_words(bytes(size))


@independent.properties(200)
@given(st.binary(max_size=80))
def test_mpeg2_agrees_with_a_bitwise_one(data):
    """The computation by zlib is equivalent."""
    assert int.from_bytes(checksum.mpeg2(data), 'little') == independent.mpeg2(data)


@independent.properties(200)
@given(WHOLE_WORDS)
def test_mpeg2_words_agrees_with_a_bitwise_one(data):
    """The computation by zlib is equivalent."""
    assert int.from_bytes(checksum.mpeg2_words(data), 'little') == independent.mpeg2_words(data)


@independent.properties(200)
@given(st.binary(max_size=80))
def test_crc32_agrees_with_a_bitwise_one(data):
    """The bytes come least significant first."""
    assert int.from_bytes(checksum.crc32(data), 'little') == independent.crc32(data)
