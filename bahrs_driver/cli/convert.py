# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs convert`: regenerate all topics from raw bytes."""

import argparse
from collections.abc import Iterator
import contextlib
from datetime import datetime, timezone
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bahrs_driver.bag.capture import Capture
from bahrs_driver.cli.capture_options import add_sensor_option, add_topic_option
from bahrs_driver.cli.convert_settings import read_settings, unused_options
from bahrs_driver.cli.printing import warn
from bahrs_driver.cli.progress import progress_bar
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import CaptureError, CommandError, WriteError
from bahrs_driver.files.new_directory import new_directory
from bahrs_driver.process.garbage_collection import rare_collections
from bahrs_driver.process.printable import printable
from bahrs_driver.reprocess.conversion import Conversion, ConversionResult
from bahrs_driver.reprocess.recording import no_frames, open_recording
from bahrs_driver.ros.start import check_import, missing_module
from bahrs_driver.tables.table_files import SINKS, table_files
from bahrs_driver.tables.table_writer import TableWriter
from bahrs_driver.units import NS_PER_S
from rich.progress import TaskID

if TYPE_CHECKING:
    from bahrs_driver.reprocess.bag_topic_writer import BagTopicWriter

_EXAMPLES = """examples:
  bahrs convert flight flight_topics              from a bag with the topic raw
  bahrs convert flight.bin flight_topics --start 2026-05-01T12:00:00Z
  bahrs convert flight flight_csv --as csv -p frame_convention:=ned
  bahrs convert flight flight_tables --as parquet  for pandas and polars
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Regenerate all topics of the driver from recorded bytes. Stamps are more accurate than\n'
        'those of the live driver, because the whole recording is used to estimate them. Stamps\n'
        'of a polled device are arrival times, because requests are not recorded. Log times are\n'
        'the stamps without the steps of the host clock.')
    parser.epilog = _EXAMPLES
    parser.add_argument('input', metavar='IN',
                        help='bag with the topic raw, or file of raw bytes')
    parser.add_argument('output', metavar='OUT', help='directory to create')
    parser.add_argument('--as', dest='kind', choices=('bag', *SINKS), default='bag',
                        help='output format: a rosbag2 directory (MCAP), or a directory with a '
                             'CSV, numpy (npz) or Parquet file per topic (default: %(default)s)')
    add_sensor_option(parser)
    parser.add_argument('--start', type=_time, metavar='TIME',
                        help='time of the first time message in a file of raw bytes, such as '
                             '2026-05-01T12:00:00Z, or in seconds since 1970 (default: stamps '
                             'are device time, counted from 1970)')
    add_topic_option(parser)
    parser.add_argument('--namespace', default='', metavar='NAME',
                        help='namespace of the converted topics (default: none)')
    parser.add_argument('-p', '--param', dest='parameters', action='append', default=[],
                        metavar='NAME:=VALUE',
                        help='set a parameter of the driver, as for the node')
    parser.add_argument('--json', action='store_true',
                        help='print the result as one JSON object')


def run(options: argparse.Namespace) -> int:
    """Convert a recording."""
    options.namespace = _checked(options.namespace)
    capture, name = open_recording(options.input, options.topic, options.sensor)
    settings, notes = read_settings(options.parameters, name)
    conversion = Conversion(capture, settings, DEVICES[name], options.start)
    with new_directory(options.output) as folder:
        with _shown_as(options.output, folder):
            result = _convert(options, conversion, capture, folder)
        if not result.frames:
            raise no_frames(options.input, name)
    _report(options, [*unused_options(options, capture.timed), *notes, *capture.notes,
                      *conversion.notices, *result.clock_steps], result)
    return 0


def _checked(namespace: str) -> str:
    """Return the namespace; CommandError if it is invalid. Only this check needs ROS."""
    if not namespace:
        return ''
    check_import()
    try:
        from bahrs_driver.cli.node_options import checked_namespace
    except ImportError as error:
        raise CommandError(f'cannot check --namespace: {missing_module(error)}') from error
    return checked_namespace(namespace)


@contextlib.contextmanager
def _shown_as(target: str, folder: Path) -> Iterator[None]:
    """Replace the temporary directory in errors by the name that the user gave."""
    try:
        yield
    except (CaptureError, WriteError) as error:
        raise CommandError(str(error).replace(printable(folder), printable(target))) from error


def _convert(options: argparse.Namespace, conversion: Conversion, capture: Capture,
             folder: Path) -> ConversionResult:
    with contextlib.closing(_open_writer(options, folder)) as writer, progress_bar() as bar, \
            rare_collections():
        tasks: dict[str, TaskID] = {}

        def progress(what: str) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=capture.size)
            bar.update(tasks[what], completed=capture.done)

        return conversion.run(writer, progress)


def _open_writer(options: argparse.Namespace, folder: Path) -> 'TableWriter | BagTopicWriter':
    if options.kind in SINKS:
        return table_files(folder, options.kind)
    try:
        from bahrs_driver.reprocess.bag_topic_writer import BagTopicWriter
    except ModuleNotFoundError as error:
        package = (error.name or '').partition('.')[0]
        raise CommandError(f'cannot write a bag: the Python package {package} is not installed: '
                           'pip install mcap rosbags') from error
    return BagTopicWriter(folder, folder.name, options.namespace)


def _report(options: argparse.Namespace, notes: list[str], result: ConversionResult) -> None:
    for note in notes:
        warn('convert', note)
    seconds = (result.last_ns - result.first_ns) / NS_PER_S
    if options.json:
        print(json.dumps({**result._asdict(), 'output': options.output, 'notes': notes}))
    else:
        print(f'{result.frames:,} frames, {result.skipped_bytes:,} stray bytes: '
              f'{result.messages:,} messages of {seconds:,.1f} s in '
              f'{printable(options.output)}')


def _time(text: str) -> int:
    """Return a time in ns since 1970."""
    try:
        seconds = float(text)
    except ValueError:
        try:
            time = datetime.fromisoformat(text.replace('Z', '+00:00'))
        except ValueError as error:
            raise argparse.ArgumentTypeError(f'{text!r} is not a time: write it as '
                                             '2026-05-01T12:00:00Z, or in seconds') from error
        seconds = (time if time.tzinfo else time.replace(tzinfo=timezone.utc)).timestamp()
    if not 0 <= seconds < 2 ** 31:
        raise argparse.ArgumentTypeError(f'{text!r} is before 1970 or after 2038')
    return round(seconds * NS_PER_S)
