# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The non-volatile memory of a BAHRS, format 1.1, one row for each field.

The blocks follow each other without gaps, little-endian, from the first byte on; most end in
the CRC-32 of their bytes. The rest of the memory is unused.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

from bahrs_driver.protocol.bahrs import checksum
from bahrs_driver.protocol.bahrs.nvm_session import PAGE_SIZE, PAGES
from bahrs_driver.protocol.layout import integer, integers, Layout, real, reals, text, Vector, wire
from bahrs_driver.protocol.memory import FoundBlock, MemoryBlock, MemoryFormat

KNOWN_FORMAT = 1, 1         # major, minor
CRC_SIZE = 4


@dataclass(frozen=True, slots=True)
class FormatVersion(MemoryBlock):
    """Version of the image's format."""

    NAME: ClassVar[str] = 'format version'

    major: int = wire(integer('I'))
    minor: int = wire(integer('I'))


@dataclass(frozen=True, slots=True)
class Installation(MemoryBlock):
    """Euler angles from the device to the vehicle, in rad."""

    NAME: ClassVar[str] = 'installation angles'

    roll: float = wire(real('f', 'rad'))
    pitch: float = wire(real('f', 'rad'))
    yaw: float = wire(real('f', 'rad'))


@dataclass(frozen=True, slots=True)
class Magnetometer(MemoryBlock):
    """Calibration of the magnetometer: hard iron, and soft iron as a matrix row by row."""

    NAME: ClassVar[str] = 'magnetometer'

    hard_iron: Vector = wire(reals('f', 3))
    soft_iron: tuple[float, ...] = wire(reals('f', 9))


@dataclass(frozen=True, slots=True)
class Assertions(MemoryBlock):
    """Log of failed assertions of the firmware: its text, and the position of the next entry."""

    NAME: ClassVar[str] = 'assertions'
    CHECKED: ClassVar[bool] = False

    position: int = wire(integer('I'))
    log: str = wire(text(512))


@dataclass(frozen=True, slots=True)
class Can(MemoryBlock):
    """Parameters of the CAN bus."""

    NAME: ClassVar[str] = 'CAN'

    node_id: int = wire(integer('I'))
    redundant_channel: int = wire(integer('I'))
    service_channel: int = wire(integer('I'))
    update_rates: tuple[int, ...] = wire(integers('I', 12))


BLOCKS: tuple[type[MemoryBlock], ...] = (
    FormatVersion, Installation, Magnetometer, Assertions, Can)


def parse(image: bytes) -> Iterator[FoundBlock]:
    """Parse the blocks of an image; raise ValueError if it is too short."""
    start = 0
    for kind in BLOCKS:
        layout = Layout(kind)
        end = start + layout.size
        if len(image) < end + CRC_SIZE * kind.CHECKED:
            raise ValueError(f'{len(image)} bytes are too few: the block {kind.NAME} is '
                             'incomplete')
        crc = image[end:end + CRC_SIZE]
        intact = checksum.crc32(image[start:end]) == crc if kind.CHECKED else None
        yield FoundBlock(layout.decode(image, start), intact)
        start = end + CRC_SIZE * kind.CHECKED


def complain(blocks: Sequence[FoundBlock]) -> str:
    """Return a warning about an image of another format; empty if the format is known."""
    version = blocks[0].block
    if not blocks[0].intact or not isinstance(version, FormatVersion) \
            or (version.major, version.minor) == KNOWN_FORMAT:
        return ''
    return (f'the image has format {version.major}.{version.minor}, and is shown as if it had '
            f'{KNOWN_FORMAT[0]}.{KNOWN_FORMAT[1]}')


MEMORY = MemoryFormat(PAGES, PAGE_SIZE, parse, complain)


def build(*blocks: MemoryBlock) -> bytes:
    """Build the bytes of an image with these blocks and their CRCs."""
    return b''.join(_build(block) for block in blocks)


def _build(block: MemoryBlock) -> bytes:
    data = Layout(type(block)).encode(block)
    return data + checksum.crc32(data) if block.CHECKED else data
