# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs report`: write a page about a recording."""

import argparse
import contextlib
import json
import os
from pathlib import Path

from bahrs_driver.bag.capture import Capture
from bahrs_driver.bag.read_capture import read_capture
from bahrs_driver.cli.outputs import add_force, is_standard_output, output_file
from bahrs_driver.cli.progress import progress_bar
from bahrs_driver.errors import CaptureError, CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.report.clock import analyze_clock
from bahrs_driver.report.findings import findings
from bahrs_driver.report.gather import gather, Recording
from bahrs_driver.report.page import page
from rich.markup import escape

_EXAMPLES = """examples:
  bahrs report flight.bin                       writes flight.html beside it
  bahrs report flight_bag -o report.html        a bag with the topic raw: clocks, too
  bahrs report flight.bin --json                the findings, for a script

exit status: 0, or 1 if the recording has no frame
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Write one self-contained page of HTML about a recording of a BAHRS: integrity,\n'
        'motion, clock, noise at rest, and findings in sentences.')
    parser.epilog = _EXAMPLES
    parser.add_argument('input', help='file of bytes from the device, or a bag with the topic '
                                      'raw')
    parser.add_argument('-o', '--output', metavar='FILE',
                        help='page to write; - is standard output (default: beside the '
                             'recording, with .html)')
    add_force(parser)
    parser.add_argument('--topic', help="the bag's topic of raw bytes, if there are several")
    parser.add_argument('--crc', choices=('auto', 'word', 'byte'), default='auto',
                        help='order of the CRC (default: %(default)s)')
    parser.add_argument('--pressure-height', choices=('uint16', 'int16'), default='uint16',
                        help='format of the pressure height (default: %(default)s)')
    parser.add_argument('--json', action='store_true',
                        help='print counts and findings as one JSON object, and write no page')


def run(options: argparse.Namespace) -> int:
    """Read the recording and write the page."""
    if options.json:
        print(json.dumps(_record(_recording(options))))
        return 0
    target = options.output or str(_target(options))
    _refuse_input(target, options.input)
    with output_file(target, options.force) as file:
        file.write(''.join(page(_recording(options))).encode(errors='backslashreplace'))
    if not is_standard_output(target):
        print(printable(target))
    return 0


def _recording(options: argparse.Namespace) -> Recording:
    """Read the recording; CommandError if it has no frame."""
    try:
        capture = read_capture(options.input, options.topic)
        if capture.sensor not in (None, 'bahrs'):
            raise CommandError(f'{printable(options.input)} is of a {printable(capture.sensor)}: '
                               'there are only reports of a bahrs')
        recording = _gather(options, capture)
    except CaptureError as error:
        raise CommandError(str(error)) from error
    if not recording.counters.frames:
        raise CommandError(f'no frame of a BAHRS in the {recording.size:,} bytes of '
                           f'{printable(options.input)}')
    return recording


def _refuse_input(target: str, source: str) -> None:
    """Raise CommandError if a target belongs to the recording, which --force must not replace."""
    with contextlib.suppress(OSError, ValueError):      # one of the two does not exist
        bag = os.path.join(os.path.realpath(source), '')
        if os.path.samefile(target, source) or os.path.realpath(target, strict=True
                                                                ).startswith(bag):
            raise CommandError(f'{printable(target)} is the recording itself: give the page '
                               'another name')


def _target(options: argparse.Namespace) -> Path:
    if options.output:
        return Path(options.output)
    source = Path(options.input)
    if source.name in ('', '..'):           # a folder without a name of its own in the path
        source = source.resolve()
    return source.with_suffix('.html')


def _gather(options: argparse.Namespace, capture: Capture) -> Recording:
    with progress_bar() as progress:
        name = escape(printable(os.path.basename(options.input)))
        task = progress.add_task(name, total=capture.size or None)
        return gather(capture, options.crc, options.pressure_height,
                      lambda: progress.update(task, completed=capture.done))


def _record(recording: Recording) -> dict[str, object]:
    analysis = analyze_clock(recording)
    return {
        'name': printable(recording.name), 'bytes': recording.size,
        'duration': round(recording.duration, 3), 'counts': recording.counts,
        'versions': recording.versions, 'crc_failures': recording.counters.crc_failures,
        'skipped_bytes': recording.counters.skipped_bytes,
        'drift_ppm': None if analysis is None else analysis.drift_ppm,
        'findings': [finding.to_json() for finding in findings(recording, analysis)]}
