# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs decode`: what is in a recorded stream of bytes."""

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator
import csv
import dataclasses
import json
import sys
from typing import Any, BinaryIO

from bahrs_driver.cli.files import binary_input
from bahrs_driver.protocol.bahrs import BahrsMessage, MESSAGES, TimeMessage
from bahrs_driver.protocol.bahrs_frames import BahrsCodec, BahrsFormat, frame_version
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.integrity import Integrity

_CHUNK = 65536
_HEAD = ('message', 'version', 'offset')
_SUFFIXES = {'specific_force': ('_x', '_y', '_z'), 'angular_rate': ('_x', '_y', '_z'),
             'unique_id': ('_1', '_2', '_3')}
_EXAMPLES = """examples:
  bahrs decode flight.bin                       what is in it
  bahrs decode --format jsonl flight.bin        one JSON object a message, SI units
  cat /dev/ttyUSB0 | bahrs decode --format csv - > flight.csv
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Decode a stream of bytes from a BAHRS. Lines of jsonl and csv are in stream order\n'
        'and SI units (rad, m, m/s, m/s^2, device time in us).')
    parser.epilog = _EXAMPLES
    parser.add_argument('file', help='file of bytes as the device sent them; - is standard input')
    parser.add_argument('--format', choices=('summary', 'jsonl', 'csv'), default='summary',
                        help='what to print (default: %(default)s)')
    parser.add_argument('--sensor', choices=('bahrs',), default='bahrs',
                        help='which device sent it (default: %(default)s)')
    parser.add_argument('--crc', choices=('auto', 'word', 'byte'), default='auto',
                        help='order of the CRC (default: %(default)s)')
    parser.add_argument('--pressure-height', choices=('uint16', 'int16'), default='uint16',
                        help='format of the pressure height (default: %(default)s)')


def run(options: argparse.Namespace) -> int:
    """Decode, and print in the format asked for; 1 if there was no frame at all."""
    frame_format = BahrsFormat(options.crc)
    framer = Framer(frame_format)
    codec = BahrsCodec(options.pressure_height)
    with binary_input(options.file) as file:
        messages = ((frame, codec.decode(frame)) for frame in _frames(file, framer))
        if options.format == 'jsonl':
            for frame, message in messages:
                print(json.dumps(record(frame, message)))
        elif options.format == 'csv':
            _print_csv(messages)
        else:
            _print_summary(Counter(message.NAME for _, message in messages),
                           framer, frame_format)
    if not framer.counters.frames:
        print(f'bahrs decode: no frame in {framer.received} bytes', file=sys.stderr)
        return 1
    return 0


def record(frame: Frame, message: BahrsMessage) -> dict[str, Any]:
    """Return a message as plain JSON values: what it is, where it stood, what it says."""
    fields = {item.name: _plain(getattr(message, item.name))
              for item in dataclasses.fields(message)}  # type: ignore[arg-type]
    if isinstance(message, TimeMessage):
        fields['valid'] = message.valid
    return {'message': message.NAME, 'version': frame_version(frame.data),
            'offset': frame.offset, **fields}


def _frames(file: BinaryIO, framer: Framer) -> Iterator[Frame]:
    read = getattr(file, 'read1', file.read)        # a pipe: print what is there, do not wait
    while chunk := read(_CHUNK):
        yield from framer.feed(chunk)
    yield from framer.flush()


def _plain(value: Any) -> Any:
    if isinstance(value, Integrity):
        return value.label
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value.hex() if isinstance(value, bytes) else value


def _print_csv(messages: Iterator[tuple[Frame, BahrsMessage]]) -> None:
    """Print a row a message, a column for every field of any message, empty where it has none."""
    columns = list(_HEAD)
    for kind in MESSAGES:
        columns += [name for name in _columns(kind) if name not in columns]
    writer = csv.DictWriter(sys.stdout, columns, lineterminator='\n')
    writer.writeheader()
    for frame, message in messages:
        fields = record(frame, message)
        row = {name: fields.pop(name) for name in _HEAD}
        names = _columns(type(message))
        row.update(zip(names, _flat(fields.values())))
        writer.writerow(row)


def _columns(kind: type[BahrsMessage]) -> list[str]:
    names = []
    for item in dataclasses.fields(kind):  # type: ignore[arg-type]
        if item.name == 'health':
            names += [f'{signal}_integrity' for signal in kind.SIGNALS]
        elif item.name in _SUFFIXES:
            names += [item.name + suffix for suffix in _SUFFIXES[item.name]]
        else:
            names.append(item.name)
    return names + ['valid'] if issubclass(kind, TimeMessage) else names


def _flat(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        if isinstance(value, list):
            yield from value
        else:
            yield value


def _print_summary(counts: Counter[str], framer: Framer, frame_format: BahrsFormat) -> None:
    counters = framer.counters
    rows = [(name, count) for name, count in counts.most_common()]
    rows += [(f'unknown type {name}', count)
             for name, count in sorted(counters.unknown_types.items())]
    for name, count in rows:
        print(f'{name:<22}{count:>12,}')
    print(f"{'bytes':<22}{framer.received:>12,}")
    print(f"{'CRC failures':<22}{counters.crc_failures:>12,}")
    print(f"{'skipped bytes':<22}{counters.skipped_bytes:>12,}")
    print(f"{'protocol version':<22}{frame_format.version_seen or '-':>12}")
    print(f"{'CRC order':<22}{frame_format.order_seen or '-':>12}")
