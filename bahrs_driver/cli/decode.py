# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs decode`: what is in a recorded stream of bytes."""

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator
import csv
import dataclasses
import errno
import json
import math
from pathlib import Path
import sys
from typing import Any, BinaryIO

from bahrs_driver.bag.bag_kind import is_bag
from bahrs_driver.cli.files import binary_input
from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.devices.stream_decoder import StreamDecoder
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.reprocess.message_times import TimedMessage, with_times

_CHUNK = 65536
TIME = 'device_time_us'
_BODY, _NED = ('_x', '_y', '_z'), ('_north', '_east', '_down')
_SUFFIXES = {'specific_force': _BODY, 'angular_rate': _BODY, 'unique_id': ('_1', '_2', '_3'),
             'position_ned': _NED, 'velocity_ned': _NED,
             'attitude': ('_roll', '_pitch', '_heading'), 'acceleration': _BODY,
             'adc_acceleration': _BODY, 'adc_angular_rate_deg': _BODY,
             'magnetic_field_tesla': _BODY}
_EXAMPLES = """examples:
  bahrs decode flight.bin                       what is in it
  bahrs decode --json flight.bin                the same for a script
  bahrs decode --format jsonl flight.bin        one JSON object a message, SI units
  stty -F /dev/ttyUSB0 115200 raw -echo && bahrs decode --format csv /dev/ttyUSB0 > flight.csv
  bahrs decode --sensor titan_m answers.bin     what a Titan-M answered
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Decode a stream of bytes from a sensor. Lines of jsonl and csv are in stream order\n'
        'and SI units (rad, m, m/s, m/s^2, device time in us) unless a name says otherwise.\n'
        'csv has the device time of each message where it is known, and an empty cell for a\n'
        'value that is not available; jsonl has values as they were sent, beside their integrity.')
    parser.epilog = _EXAMPLES
    parser.add_argument('file', help='file of bytes as the device sent them, or a port that stty '
                                     'has set; - is standard input')
    parser.add_argument('--format', choices=('summary', 'jsonl', 'csv'), default='summary',
                        help='what to print (default: %(default)s)')
    parser.add_argument('--sensor', choices=tuple(DEVICES), default=DEFAULT,
                        help='which device sent it (default: %(default)s)')
    for spec in DEVICES.values():
        spec.stream_decoder.add_arguments(parser)
    parser.add_argument('--json', action='store_true',
                        help='print the summary as one JSON object')


def run(options: argparse.Namespace) -> int:
    """Decode, and print in the format asked for; 1 if there was nothing to decode at all."""
    _refuse_bag(Path(options.file))
    spec = DEVICES[options.sensor]
    decoder = spec.stream_decoder(options)
    framer = decoder.framer
    with binary_input(options.file) as file:
        messages = decoder.messages(_frames(file, framer))
        if options.format == 'jsonl':
            for frame, message in messages:
                print(json.dumps(record(decoder, frame, message)))
        elif options.format == 'csv':
            _print_csv(decoder, _timed(messages, spec.roles))
        else:
            counts = Counter(message.NAME for _, message in messages)
            (_print_json if options.json else _print_summary)(counts, decoder)
    complaint = decoder.complaint()
    if not framer.counters.frames:
        others = ' or '.join(f'--sensor {name}' for name in DEVICES if name != options.sensor)
        complaint = (f'no frame of a {options.sensor} in {framer.received} bytes; '
                     f'if they are of another device, try {others}')
    if complaint:
        print(f'bahrs decode: {complaint}', file=sys.stderr)
    return 1 if complaint else 0


def _refuse_bag(path: Path) -> None:
    """Raise CommandError for a bag: the bytes of its storage would be taken for damage."""
    if path.is_file() and is_bag(path):
        raise CommandError(f'{printable(path)} is a bag: make topics or CSV files of it with '
                           'bahrs convert, or a page with bahrs report')


def record(decoder: StreamDecoder, frame: Frame, message: Any) -> dict[str, Any]:
    """Return a message as plain JSON values: what it is, where it stood, what it says."""
    fields = {item.name: _plain(getattr(message, item.name))
              for item in dataclasses.fields(message)}
    fields.update((name, _plain(getattr(message, name))) for name in message.PROPERTIES)
    return {'message': message.NAME, **decoder.head_values(frame), 'offset': frame.offset,
            **fields}


def _frames(file: BinaryIO, framer: Framer) -> Iterator[Frame]:
    read = getattr(file, 'read1', file.read)        # a pipe: print what is there, do not wait
    try:
        while chunk := read(_CHUNK):
            yield from framer.feed(chunk)
    except OSError as error:
        if error.errno != errno.EIO:            # a port that is gone is the end of its stream
            raise
    yield from framer.flush()


def _plain(value: Any) -> Any:
    if isinstance(value, Integrity):
        return value.label
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None             # which JSON has no number for, and CSV an empty cell
    return value.hex() if isinstance(value, bytes) else value


def _print_csv(decoder: StreamDecoder, messages: Iterable[TimedMessage]) -> None:
    """
    Print a row a message, a column for every field of any message.

    A cell is empty where the message has no such field, or its value is not available: a number
    would be taken for a measurement. Device time is that of the message itself, as its counter and
    the time messages around it tell.
    """
    head = ('message', *decoder.head, 'offset')
    columns = list(head)
    for kind in decoder.kinds:
        columns += [name for name in _columns(kind) if name not in columns]
    if TIME in columns:
        columns.remove(TIME)
        columns.insert(1, TIME)
    writer = csv.DictWriter(sys.stdout, columns, lineterminator='\n')
    writer.writeheader()
    for frame, message, time_us in messages:
        fields = record(decoder, frame, message)
        row = {name: fields.pop(name) for name in head}
        row.update(zip(_columns(type(message)), _flat(fields.values())))
        row.update(dict.fromkeys(decoder.unavailable(message)))
        writer.writerow({**row, TIME: time_us} if TIME in columns else row)


def _timed(messages: Iterable[tuple[Frame, Any]],
           roles: MessageRoles | None) -> Iterable[TimedMessage]:
    """Return the messages with their device time in us; None if it is unknown."""
    if roles:
        return with_times(messages, roles)
    return ((frame, message, None) for frame, message in messages)


def _columns(kind: type[Any]) -> list[str]:
    names = []
    for item in dataclasses.fields(kind):
        if item.name == 'health':
            names += [f'{signal}_integrity' for signal in kind.SIGNALS]
        elif item.name in _SUFFIXES:
            names += [item.name + suffix for suffix in _SUFFIXES[item.name]]
        else:
            names.append(item.name)
    return [*names, *kind.PROPERTIES]


def _flat(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        if isinstance(value, list):
            yield from value
        else:
            yield printable(value) if isinstance(value, str) else value


def _print_json(counts: Counter[str], decoder: StreamDecoder) -> None:
    framer = decoder.framer
    counters = framer.counters
    print(json.dumps({
        'counts': counts, 'unknown_types': dict(counters.unknown_types), 'bytes': framer.received,
        'crc_failures': counters.crc_failures, 'skipped_bytes': counters.skipped_bytes,
        **{name.lower().replace(' ', '_'): value for name, value in decoder.detected()}}))


def _print_summary(counts: Counter[str], decoder: StreamDecoder) -> None:
    framer = decoder.framer
    counters = framer.counters
    rows = [(name, count) for name, count in counts.most_common()]
    rows += [(f'unknown type {name}', count)
             for name, count in sorted(counters.unknown_types.items())]
    rows += [('bytes', framer.received), ('CRC failures', counters.crc_failures),
             ('skipped bytes', counters.skipped_bytes)]
    for name, count in rows:
        print(f'{name:<22}{count:>12,}')
    for name, value in decoder.detected():
        print(f"{name:<22}{value or '-':>12}")
