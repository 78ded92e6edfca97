# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print the content of a memory image, for `bahrs nvm show`."""

from collections.abc import Sequence
from dataclasses import asdict, fields
import json
import math

from bahrs_driver.cli.inputs import binary_input
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.memory import FoundBlock, MemoryFormat

ERASED = '\xff'         # byte of erased memory
_CRC_RESULTS = {True: 'CRC good', False: 'CRC BAD', None: 'no CRC'}


def read_image(name: str, memory: MemoryFormat) -> list[FoundBlock]:
    """Return the blocks of an image; CommandError if the file is not an image."""
    with binary_input(name) as file:
        image = file.read(memory.size + 1)
    if len(image) > memory.size:
        raise CommandError(f'{name} is not an image: an image has {memory.size:,} bytes')
    try:
        return list(memory.parse(image))
    except ValueError as error:
        raise CommandError(f'{name} is not an image: {error}') from error


def print_json(blocks: Sequence[FoundBlock]) -> None:
    """Print the blocks as one JSON object."""
    print(json.dumps({found.block.NAME: {
        'intact': found.intact,
        **{name: _json_value(value) for name, value in asdict(found.block).items()}}
        for found in blocks}))


def print_text(blocks: Sequence[FoundBlock]) -> None:
    """Print each block, one line per field."""
    for found in blocks:
        print(f'{found.block.NAME} ({_CRC_RESULTS[found.intact]})')
        for item in fields(found.block):
            value, unit = getattr(found.block, item.name), item.metadata['rows'][1].unit
            if isinstance(value, str):
                _print_lines(value)
            else:
                print(f'  {item.name:<20}{_format(value)} {unit}'.rstrip())


def _print_lines(value: str) -> None:
    text = value.rstrip(f'\n{ERASED}')
    for line in text.split('\n') if text else ['none']:
        print(f'  {printable(line, len(value) * 4 + 1)}')


def _json_value(value: object) -> object:
    """Return a value that JSON has: null in place of NaN."""
    if isinstance(value, tuple):
        return [_json_value(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _format(value: object) -> str:
    if isinstance(value, tuple):
        return ' '.join(map(_format, value))
    return f'{value:.6g}' if isinstance(value, float) else str(value)
