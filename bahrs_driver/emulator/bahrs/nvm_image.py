# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""An invented image of the non-volatile memory of a BAHRS, in the real format 1.1."""

from bahrs_driver.protocol.bahrs.nvm_image import (
    Assertions,
    build,
    Can,
    FormatVersion,
    Installation,
    Magnetometer,
)
from bahrs_driver.protocol.bahrs.nvm_session import PAGE_SIZE, PAGES

SIZE = PAGES * PAGE_SIZE
_ASSERTION = 'Emulator.cpp:1 assert(device is real)\n'


def example_image() -> bytes:
    """Return a complete image."""
    blocks = build(
        FormatVersion(1, 1),
        Installation(0.02, -0.01, 0.0),
        Magnetometer((8.25, -4.5, 30.0), (1.0, 0.01, 0.0, 0.01, 0.99, 0.0, 0.0, 0.0, 1.01)),
        Assertions(len(_ASSERTION), _ASSERTION),
        Can(42, 0, 8, (*[80] * 11, 10)))
    return blocks.ljust(SIZE, b'\0')


def page(image: bytes, number: int) -> bytes:
    """Return one page of an image."""
    return image[number * PAGE_SIZE:(number + 1) * PAGE_SIZE]
