# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the image of the memory."""

import struct
import zlib

from bahrs_driver.protocol.bahrs.nvm_image import (
    Assertions, build, Can, FormatVersion, Installation, Magnetometer, parse,
)
import pytest
from support.shared_files import shared_file

SOFT_IRON = (1.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 2.0)
BLOCKS = (FormatVersion(1, 1), Installation(0.5, -0.25, 1.5),
          Magnetometer((12.5, -3.25, 40.0), SOFT_IRON), Assertions(7, 'a.c:3 x\n'),
          Can(45, 0, 8, (80,) * 11 + (10,)))
START = {'installation angles': 12, 'magnetometer': 28, 'CAN': 80 + 516}


def test_layout_is_that_of_the_device():
    """Byte by byte, built without the code under test."""
    image = build(*BLOCKS)
    version = struct.pack('<2I', 1, 1)
    assert image[:12] == version + struct.pack('<I', zlib.crc32(version))
    assert image[12:24] == struct.pack('<3f', 0.5, -0.25, 1.5)
    assert image[28:76] == struct.pack('<12f', 12.5, -3.25, 40.0, *SOFT_IRON)
    assert image[80:84] == struct.pack('<I', 7) and image[84:92] == b'a.c:3 x\n'
    can = image[596:656]
    assert struct.unpack('<15I', can) == (45, 0, 8, *[80] * 11, 10)
    assert image[656:] == struct.pack('<I', zlib.crc32(can)) and len(image) == 660


def test_an_image_is_parsed_into_its_blocks():
    """All CRCs are correct; the assertions have none."""
    found = list(parse(build(*BLOCKS).ljust(8000, b'\xff')))
    assert [item.block for item in found] == list(BLOCKS)
    assert [item.intact for item in found] == [True, True, True, None, True]


@pytest.mark.parametrize('name', START)
def test_a_damaged_block_is_named(name):
    """The others are intact."""
    image = bytearray(build(*BLOCKS))
    image[START[name] + 2] ^= 1
    damaged = [item.block.NAME for item in parse(image) if item.intact is False]
    assert damaged == [name]


@pytest.mark.parametrize('size', [0, 11, 100, 659])
def test_an_image_that_is_too_short_is_refused(size):
    """The error names the incomplete block."""
    with pytest.raises(ValueError, match='bytes are too few: the block .* is incomplete'):
        list(parse(build(*BLOCKS)[:size]))


def test_an_image_of_the_maker_is_parsed():
    """Its tool wrote the layout."""
    version, installation, magnetometer, assertions, can = parse(
        shared_file('data/nvm_image_example_1_1.bin').read_bytes())
    assert version == (FormatVersion(1, 1), True)
    angles = installation.block
    assert (angles.roll, angles.pitch, angles.yaw) == pytest.approx(
        (0.01, -0.02, 1.5708), rel=1e-5)
    assert magnetometer.block.hard_iron == (12.5, -3.25, 40.0)
    assert assertions.block.log == 'CRte.cpp:88 assert(false)\n'
    assert can.block.node_id == 45
    assert [item.intact for item in (version, installation, magnetometer, can)] == [True] * 4
