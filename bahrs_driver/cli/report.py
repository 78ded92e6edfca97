# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs report`: write a page about a recording."""

import argparse
from collections.abc import Iterator
import contextlib
import json
import os
from pathlib import Path

from bahrs_driver.bag.capture import Capture
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.cli.capture_options import add_topic_option
from bahrs_driver.cli.outputs import add_force, is_standard_output, output_file
from bahrs_driver.cli.progress import progress_bar
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.report.clock import analyze_clock
from bahrs_driver.report.findings import findings
from bahrs_driver.report.gather import gather, Recording
from bahrs_driver.report.page import page
from rich.markup import escape

EXIT_STATUS = '0, or 1 if the recording has no frame'
_EXAMPLES = """examples:
  bahrs report flight.bin                       write flight.html beside it
  bahrs report flight_bag -o report.html        a bag also shows the clocks
  bahrs report flight.bin --json                findings for a script
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Write a self-contained HTML page about a recording: integrity, motion, clock, noise at\n'
        'rest, and findings in sentences.')
    parser.epilog = _EXAMPLES
    parser.add_argument('input', help='bag with the topic raw, or file of raw bytes')
    parser.add_argument('-o', '--output', metavar='FILE',
                        help='HTML file to create; - is standard output (default: the name of '
                             'the recording with .html)')
    add_force(parser)
    add_topic_option(parser)
    for spec in _reported():
        spec.stream_decoder.add_arguments(parser)
    parser.add_argument('--json', action='store_true',
                        help='print counts and findings as one JSON object; write no page')


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
    capture = open_capture(options.input, options.topic)
    specs = {spec.name: spec for spec in _reported()}
    spec = specs.get(capture.sensor or next(iter(specs)))
    if spec is None:
        raise CommandError(f'{printable(options.input)} is of a {printable(capture.sensor)}: '
                           f'there are only reports of a {" or ".join(specs)}')
    recording = _gather(options, capture, spec)
    if not recording.counters.frames:
        raise CommandError(f'no frame of a {spec.label} in the {recording.size:,} bytes of '
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


def _reported() -> Iterator[AnyDevice]:
    """Yield the devices whose recordings have reports."""
    return (spec for spec in DEVICES.values() if spec.recording_format(spec.settings()))


def _gather(options: argparse.Namespace, capture: Capture, spec: AnyDevice) -> Recording:
    settings = spec.stream_decoder.settings(options) or spec.settings()
    recorded = spec.recording_format(settings)
    assert recorded, 'only devices with a format are reported'
    with progress_bar() as progress:
        name = escape(printable(os.path.basename(options.input)))
        task = progress.add_task(name, total=capture.size or None)
        return gather(capture, recorded, lambda: progress.update(task, completed=capture.done))


def _record(recording: Recording) -> dict[str, object]:
    analysis = analyze_clock(recording)
    return {
        'name': printable(recording.name), 'bytes': recording.size,
        'duration': round(recording.duration, 3), 'counts': recording.counts,
        'versions': recording.versions, 'crc_failures': recording.counters.crc_failures,
        'skipped_bytes': recording.counters.skipped_bytes,
        'drift_ppm': None if analysis is None else analysis.drift_ppm,
        'findings': [finding.to_json() for finding in findings(recording, analysis)]}
