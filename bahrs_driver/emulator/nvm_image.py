# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What is in the non-volatile memory of an emulated BAHRS: made up, in the real format 1.1."""

import struct
import zlib

PAGE_SIZE = 32
PAGES = 250
SIZE = PAGES * PAGE_SIZE

_ASSERTION_SIZE = 512
_ASSERTION = b'Emulator.cpp:1 assert(device is real)\n'


def made_up_image() -> bytes:
    """Return a whole image; each block but the assertions ends in its CRC-32."""
    version = struct.pack('<2I', 1, 1)
    installation = struct.pack('<3f', 0.02, -0.01, 0.0)             # roll, pitch, yaw in rad
    magnetometer = struct.pack('<12f', 8.25, -4.5, 30.0,            # hard iron, then soft iron
                               1.0, 0.01, 0.0, 0.01, 0.99, 0.0, 0.0, 0.0, 1.01)
    assertions = struct.pack('<I', len(_ASSERTION)) + _ASSERTION.ljust(_ASSERTION_SIZE, b'\0')
    can = struct.pack('<15I', 42, 0, 8, *[80] * 11, 10)
    image = (_checked(version) + _checked(installation) + _checked(magnetometer) + assertions
             + _checked(can))
    return image.ljust(SIZE, b'\0')


def page(image: bytes, number: int) -> bytes:
    """Return one page of an image."""
    return image[number * PAGE_SIZE:(number + 1) * PAGE_SIZE]


def _checked(block: bytes) -> bytes:
    return block + struct.pack('<I', zlib.crc32(block))
