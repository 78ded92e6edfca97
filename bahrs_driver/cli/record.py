# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs record`: record the topics of the driver into a bag."""

import argparse
from collections.abc import Iterator
import contextlib
from functools import partial
from itertools import chain, count
import json
import math
import time

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.recorder import Recorder
from bahrs_driver.bag.stored_message import RAW_TOPIC
from bahrs_driver.cli.node_options import add_node_options, selected_node, several_nodes
from bahrs_driver.cli.printing import print_counts, warn
from bahrs_driver.cli.ros_session import ros_session
from bahrs_driver.cli.signals import shutdown_on_signal
from bahrs_driver.errors import CommandError, TargetExists, WriteError
from bahrs_driver.process.argument_types import positive_float
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.process.printable import printable
from bahrs_driver.process.shutdown_event import ShutdownEvent
from bahrs_driver.ros.start_errors import start_errors
from rich.console import Console
from rich.markup import escape

WRITE_PERIOD = 0.25             # s; a killed recorder loses this and the messages it holds
SYNC_PERIOD = 1.0               # s; a loss of power loses this and the cache of the disk
EMPTY_TIMEOUT = 5.0             # s without a message, after which the reason is printed
FIRST_WAIT = 30.0               # s for the first message, if there is a duration
MEGABYTE = 1_000_000
NO_DATA_TOPICS = ('/diagnostics', '/rosout')    # a missed message is no loss of data

_EXAMPLES = """examples:
  bahrs record                              all topics of the driver, until Ctrl-C
  bahrs record --raw-only --output flight   only the bytes, to convert them later
  bahrs record --max-size 500 --duration 3600 --json
  ros2 bag play flight
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Record all topics of the driver into a rosbag2 directory (MCAP), including topics that\n'
        'appear later. If the recorder is killed, only the last second is lost. Ctrl-C ends the\n'
        'recording with exit status 0.')
    parser.epilog = _EXAMPLES
    parser.add_argument('-o', '--output', metavar='DIRECTORY',
                        help='directory to create (default: bahrs_ with date and time)')
    parser.add_argument('--raw-only', action='store_true',
                        help='record only the topic raw, which a driver with publish.raw:=true '
                             'publishes; "bahrs convert" regenerates the others')
    parser.add_argument('--max-size', type=positive_float, default=math.inf, metavar='MB',
                        help='start a new file at this size (default: never)')
    parser.add_argument('--max-duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='start a new file after this time (default: never)')
    parser.add_argument('--duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='record for this time from the first message on; end also if no '
                             f'message arrives within {FIRST_WAIT:g} s (default: until Ctrl-C)')
    add_node_options(parser)
    parser.add_argument('--json', action='store_true',
                        help='print the result as one JSON object at the end')


def run(options: argparse.Namespace) -> int:
    """Record until the duration is over or a signal arrives; 1 if the bag is empty."""
    selection = selected_node(options)
    failure = ''
    faults = FaultLog(partial(warn, 'record'), str)
    with shutdown_on_signal() as shutdown, ros_session(options) as keep:
        bag = new_bag(options.output)
        with start_errors(options.ros_arguments):
            recorder = keep(Recorder(
                selection, options.raw_only,
                lambda error: faults.report('receiving a message', error)))
        recorder.start()
        try:
            with contextlib.closing(bag):
                _record(options, recorder, bag, shutdown)
        except WriteError as error:
            failure = str(error)
    _report(options, recorder, bag, failure)
    if failure:
        raise CommandError(f'recording stopped: {failure}; the bag has all earlier messages')
    if not bag.count:
        raise CommandError(f'{printable(bag.folder)} is empty: {_why_empty(options, recorder)}')
    return 0


def new_bag(output: str | None) -> BagWriter:
    """Create the named bag, or one with a free name."""
    base = output or time.strftime('bahrs_%Y_%m_%d-%H_%M_%S')
    for folder in chain([base], (f'{base}_{number}' for number in count(2))):
        try:
            return BagWriter(folder)
        except TargetExists:
            if output:
                raise
    raise AssertionError('there is always a free name')


def _record(options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
            shutdown: ShutdownEvent) -> None:
    """Write the messages that arrive, until the end."""
    begin = time.monotonic()
    end = begin + max(options.duration, FIRST_WAIT)
    files = _FileRotation(bag, options.max_size * MEGABYTE, options.max_duration, begin)
    display = _Display(options, recorder, bag, begin)
    try:
        with display.line:
            while not shutdown.wait(min(WRITE_PERIOD, max(0.0, end - time.monotonic()))):
                now = time.monotonic()
                if recorder.choice.several:
                    raise several_nodes(recorder.choice.several)
                was_empty = not bag.count
                _write(recorder, bag, recorder.advance_watermark())
                if was_empty and bag.count:
                    end = now + options.duration
                files.update(now)
                display.update(now)
                if now >= end:
                    break
    finally:
        recorder.stop()
    _write(recorder, bag)


class _FileRotation:
    """Syncs the file of a bag, and starts the next one at a size in bytes or an age in s."""

    def __init__(self, bag: BagWriter, max_size: float, max_duration: float, now: float) -> None:
        self._bag = bag
        self._max_size, self._max_duration = max_size, max_duration
        self._begin = self._synced = now

    def update(self, now: float) -> None:
        """Sync or split if due."""
        if now >= self._synced + SYNC_PERIOD:
            self._bag.sync()
            self._synced = now
        if self._bag.size >= self._max_size or now - self._begin >= self._max_duration:
            self._bag.split()
            self._begin = now


class _Display:
    """Shows the progress of a recording, or the reason why it is empty."""

    def __init__(self, options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
                 begin: float) -> None:
        self._options, self._recorder, self._bag, self._begin = options, recorder, bag, begin
        self._console = Console(stderr=True)
        self._shown_reason = ''
        self._title = f'recording into {escape(printable(bag.folder))}'
        self.line = self._console.status(self._title)       # shown while it is entered

    def update(self, now: float) -> None:
        """Show the counts; print a new reason for an empty bag."""
        bag = self._bag
        self.line.update(f'{self._title}: {bag.count:,} messages of {len(bag.counts())} topics, '
                         f'{now - self._begin:.0f} s')
        if not bag.count and now - self._begin > EMPTY_TIMEOUT:
            reason = _why_empty(self._options, self._recorder)
            if reason != self._shown_reason:
                self._console.print(escape(f'bahrs record: {reason}'), soft_wrap=True)
                self._shown_reason = reason


def _write(recorder: Recorder, bag: BagWriter, until: float = math.inf) -> None:
    topics = recorder.new_topics()
    if topics:
        bag.add_topics(topics)
    bag.write(recorder.drain(until))
    bag.flush()


def _why_empty(options: argparse.Namespace, recorder: Recorder) -> str:
    """Return the reason why no message arrives."""
    if not recorder.node_seen:
        return f'there is no {recorder.choice.selection}: start the driver, or name it with --node'
    if options.raw_only:
        return (f'the driver does not publish {RAW_TOPIC}: start it with '
                '--ros-args -p publish.raw:=true')
    return 'the driver publishes nothing'


def _report(options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
            failure: str) -> None:
    counts = bag.counts()
    if options.json:
        print(json.dumps({
            'bag': str(bag.folder), 'files': bag.files(), 'messages': bag.count,
            'topics': counts, 'lost': recorder.lost + recorder.dropped,
            'missed_before_discovery': recorder.missed,
            'clock_steps': recorder.clock_steps, 'notes': recorder.notes,
            'error': failure or None}))
        return
    print_counts(((printable(topic), number) for topic, number in sorted(counts.items())),
                 width=32)
    for sentence in _warnings(recorder):
        warn('record', sentence)
    if counts and not any(topic.endswith(f'/{RAW_TOPIC}') for topic in counts):
        warn('record', f'this bag cannot be converted without {RAW_TOPIC}: start the driver '
                       'with -p publish.raw:=true')


def _warnings(recorder: Recorder) -> Iterator[str]:
    """Yield sentences about messages missing from the bag."""
    missed = sum(number for topic, number in recorder.missed.items()
                 if topic not in NO_DATA_TOPICS)
    if missed:
        yield (f'{missed} messages were published before the recorder was connected: start the '
               'driver with -p startup.wait_for_subscribers:=10')
    if recorder.lost:
        yield f'{recorder.lost} messages were lost in transport: the machine is too busy'
    if recorder.dropped:
        yield (f'{recorder.dropped} messages were not written: the disk is too slow, choose '
               'another, or record with --raw-only')
    yield from recorder.clock_steps
    yield from recorder.notes
