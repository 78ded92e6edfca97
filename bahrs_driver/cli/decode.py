# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs decode`: print the messages in a stream of bytes."""

import argparse
from collections.abc import Iterable, Iterator
import csv
import dataclasses
import errno
import json
import math
from pathlib import Path
import sys
from typing import BinaryIO

from bahrs_driver.bag.bag_kind import is_bag
from bahrs_driver.cli.inputs import binary_input
from bahrs_driver.cli.printing import print_counts, warn
from bahrs_driver.devices.registry import DEFAULT, DEVICES, examples
from bahrs_driver.devices.stream_decoder import AnyDecoder
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.message import Message
from bahrs_driver.reprocess.decode import decode_stream
from bahrs_driver.reprocess.decoding_faults import DecodingFaults
from bahrs_driver.reprocess.message_times import TimedMessage, with_device_time
from bahrs_driver.reprocess.stream_summary import StreamSummary, summarize

_CHUNK = 65536          # bytes
_BLOCK = 4_194_304      # bytes, for what is counted only
TIME = 'device_time_us'
_BODY, _NED = ('_x', '_y', '_z'), ('_north', '_east', '_down')
_SUFFIXES = {'specific_force': _BODY, 'angular_rate': _BODY, 'unique_id': ('_1', '_2', '_3'),
             'position_ned': _NED, 'velocity_ned': _NED,
             'attitude': ('_roll', '_pitch', '_heading'), 'acceleration': _BODY,
             'adc_acceleration': _BODY, 'adc_angular_rate_deg': _BODY,
             'magnetic_field_tesla': _BODY}
_EXAMPLES = """examples:
  bahrs decode flight.bin                       count the messages
  bahrs decode --json flight.bin                the same for a script
  bahrs decode --format jsonl flight.bin        one JSON object per message, SI units
  stty -F /dev/ttyUSB0 115200 raw -echo && bahrs decode --format csv /dev/ttyUSB0 > flight.csv
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Decode the messages in a stream of bytes from a sensor. jsonl and csv have one line per\n'
        'message, in stream order and SI units (rad, m, m/s, m/s^2, device time in us) unless a\n'
        'name says otherwise. csv has the device time of each message if it is known, and an\n'
        'empty cell for an unavailable value; jsonl has each value as it was sent, with its\n'
        'integrity.')
    parser.epilog = _EXAMPLES + examples('decode')
    parser.add_argument('file', help='file of raw bytes, or a serial port in raw mode (see the '
                                     'example with stty); - is standard input')
    parser.add_argument('--format', choices=('summary', 'jsonl', 'csv'), default='summary',
                        help='output format (default: %(default)s)')
    parser.add_argument('--sensor', choices=tuple(DEVICES), default=DEFAULT,
                        help='device that sent the bytes (default: %(default)s)')
    for spec in DEVICES.values():
        spec.stream_decoder.add_arguments(parser)
    parser.add_argument('--json', action='store_true',
                        help='print the summary as one JSON object')


def run(options: argparse.Namespace) -> int:
    """Print a stream in the chosen format; return 1 if not all of its messages are decoded."""
    _refuse_bag(Path(options.file))
    spec = DEVICES[options.sensor]
    decoder = spec.stream_decoder(spec.stream_decoder.settings(options) or spec.settings())
    faults = DecodingFaults()
    with binary_input(options.file) as file:
        frames, size = _print_stream(file, decoder, faults, options)
    problems = [*_problems(frames, size, decoder, options.sensor), *faults.notices()]
    for problem in problems:
        warn('decode', problem)
    return 1 if problems else 0


def _print_stream(file: BinaryIO, decoder: AnyDecoder, faults: DecodingFaults,
                  options: argparse.Namespace) -> tuple[int, int]:
    """Print a stream in the chosen format; return its frames and bytes."""
    if options.format == 'summary':
        summary = summarize(_chunks(file, _BLOCK), decoder, faults)
        (_print_json if options.json else _print_summary)(summary, decoder)
        return summary.framing.frames, summary.bytes_received
    messages = decode_stream(_chunks(file, _CHUNK), decoder, faults)
    if options.format == 'csv':
        _print_csv(decoder, with_device_time(messages, DEVICES[options.sensor].roles))
    else:
        for frame, message in messages:
            print(json.dumps(record(decoder, frame, message)))
    counters = decoder.pipeline.counters
    return counters.framing.frames, counters.bytes_received


def _problems(frames: int, size: int, decoder: AnyDecoder, sensor: str) -> Iterator[str]:
    """Yield the reasons why messages are missing."""
    if not frames:
        others = ' or '.join(f'--sensor {name}' for name in DEVICES if name != sensor)
        yield (f'no frame of a {sensor} in {size} bytes; if they are of '
               f'another device, try {others}')
    elif complaint := decoder.complaint():
        yield complaint


def _refuse_bag(path: Path) -> None:
    """Raise CommandError for a bag, whose storage looks like damaged frames."""
    if path.is_file() and is_bag(path):
        raise CommandError(f'{printable(path)} is a bag: use bahrs convert to make topics or CSV '
                           'files of it, or bahrs report to make a page')


def record(decoder: AnyDecoder, frame: Frame, message: Message) -> dict[str, object]:
    """Return name, offset and fields of a message as JSON values."""
    fields = {item.name: _json_value(getattr(message, item.name))
              for item in dataclasses.fields(message)}
    fields.update((name, _json_value(getattr(message, name))) for name in message.PROPERTIES)
    return {'message': message.NAME, **decoder.head_values(frame), 'offset': frame.offset,
            **fields}


def _chunks(file: BinaryIO, size: int) -> Iterator[bytes]:
    read = getattr(file, 'read1', file.read)        # does not wait for more bytes from a pipe
    try:
        while chunk := read(size):
            yield chunk
    except OSError as error:
        if error.errno != errno.EIO:            # a port that is unplugged ends its stream
            raise


def _json_value(value: object) -> object:
    if isinstance(value, Integrity):
        return value.label
    if isinstance(value, tuple):
        return [_json_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None             # JSON has no number for it; CSV has an empty cell
    return value.hex() if isinstance(value, bytes) else value


def _print_csv(decoder: AnyDecoder, messages: Iterable[TimedMessage]) -> None:
    """
    Print a row for each message, with a column for every field of any message.

    A cell is empty if the message has no such field or the value is unavailable, because a number
    would look like a measurement.
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
        row.update(zip(_columns(type(message)), _cells(fields.values())))
        row.update(dict.fromkeys(decoder.unavailable(message)))
        writer.writerow({**row, TIME: time_us} if TIME in columns else row)


def _columns(kind: type[Message]) -> list[str]:
    """Return the column of each cell of a message."""
    names = []
    for item in dataclasses.fields(kind):
        if item.name == 'health':
            names += [f'{signal}_integrity' for signal in kind.SIGNALS]
        elif item.name in _SUFFIXES:
            names += [item.name + suffix for suffix in _SUFFIXES[item.name]]
        else:
            names.append(item.name)
    return [*names, *kind.PROPERTIES]


def _cells(values: Iterable[object]) -> Iterator[object]:
    """Yield one cell for each component of the values of record()."""
    for value in values:
        if isinstance(value, list):
            yield from value
        else:
            yield printable(value) if isinstance(value, str) else value


def _print_json(summary: StreamSummary, decoder: AnyDecoder) -> None:
    framing = summary.framing
    print(json.dumps({
        'counts': summary.counts, 'unknown_types': dict(framing.unknown_types),
        'bytes': summary.bytes_received, 'crc_failures': framing.crc_failures,
        'skipped_bytes': framing.skipped_bytes,
        **{name.lower().replace(' ', '_'): value for name, value in decoder.detected()}}))


def _print_summary(summary: StreamSummary, decoder: AnyDecoder) -> None:
    framing = summary.framing
    rows = summary.counts.most_common()
    rows += [(f'unknown type {name}', count)
             for name, count in sorted(framing.unknown_types.items())]
    rows += [('bytes', summary.bytes_received), ('CRC failures', framing.crc_failures),
             ('skipped bytes', framing.skipped_bytes)]
    print_counts(rows)
    for name, value in decoder.detected():
        print(f"{name:<22}{value or '-':>12}")
