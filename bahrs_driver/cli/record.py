# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs record`: record the topics of the driver into a bag."""

import argparse
from collections.abc import Iterator
import contextlib
from itertools import chain, count
import json
import math
import sys
import time

from bahrs_driver.bag.bag_output import BagWriter
from bahrs_driver.bag.recorder import RAW, Recorder
from bahrs_driver.cli.node_options import add_node_options, selected_node, several_nodes
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
NOTHING_TIMEOUT = 5.0           # s without a message, after which the reason is printed
FIRST_WAIT = 30.0               # s for the first message, if there is a duration
MEGABYTE = 1_000_000
REPEATED = ('/diagnostics', '/rosout')      # topics whose first messages are no data

_EXAMPLES = """examples:
  bahrs record                              all topics of the driver, until Ctrl-C
  bahrs record --raw-only --output flight   only the bytes, to convert them later
  bahrs record --max-size 500 --duration 3600 --json
  ros2 bag play flight
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Record all topics of the driver into a rosbag2 directory (MCAP), including those that\n'
        'appear later. Even if it is killed, all but the last second can be read. Ctrl-C ends\n'
        'the recording with exit status 0.')
    parser.epilog = _EXAMPLES
    parser.add_argument('-o', '--output', metavar='DIRECTORY',
                        help='bag to create (default: bahrs_ and the time)')
    parser.add_argument('--raw-only', action='store_true',
                        help='record only the topic raw, which the driver publishes with '
                             'publish.raw:=true; "bahrs convert" regenerates the others')
    parser.add_argument('--max-size', type=positive_float, default=math.inf, metavar='MB',
                        help='start another file at this size (default: never)')
    parser.add_argument('--max-duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='start another file after this time (default: never)')
    parser.add_argument('--duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='end after this time of data, or if none arrives for '
                             f'{FIRST_WAIT:g} s (default: at Ctrl-C)')
    add_node_options(parser)
    parser.add_argument('--json', action='store_true',
                        help='print the result as a JSON object at the end')


def run(options: argparse.Namespace) -> int:
    """Record until the duration is over or a signal arrives; 1 if the bag is empty."""
    selection = selected_node(options)
    failure = ''
    faults = FaultLog(lambda text: print(f'bahrs record: {text}', file=sys.stderr), str)
    with shutdown_on_signal() as ended, ros_session(options) as keep:
        bag = new_bag(options.output)
        with start_errors(options.ros_arguments):
            recorder = keep(Recorder(
                selection, options.raw_only,
                lambda error: faults.report('receiving a message', error)))
        recorder.start()
        try:
            with contextlib.closing(bag):
                _record(options, recorder, bag, ended)
        except WriteError as error:
            failure = str(error)
    _report(options, recorder, bag, failure)
    if failure:
        raise CommandError(f'recording stopped: {failure}; the bag has all earlier messages')
    if not bag.count:
        raise CommandError(f'{printable(bag.folder)} is empty: {_nothing(options, recorder)}')
    return 0


def new_bag(output: str | None) -> BagWriter:
    """Create the named bag, or one under a free name."""
    base = output or time.strftime('bahrs_%Y_%m_%d-%H_%M_%S')
    for folder in chain([base], (f'{base}_{number}' for number in count(2))):
        try:
            return BagWriter(folder)
        except TargetExists:
            if output:
                raise
    raise AssertionError('names are endless')


def _record(options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
            ended: ShutdownEvent) -> None:
    """Write the messages that arrive, until the end."""
    begin = time.monotonic()
    end, empty = begin + max(options.duration, FIRST_WAIT), True
    files = _Files(bag, options.max_size * MEGABYTE, options.max_duration, begin)
    display = _Display(options, recorder, bag, begin)
    try:
        with display:
            while not ended.wait(min(WRITE_PERIOD, max(0.0, end - time.monotonic()))):
                now = time.monotonic()
                if recorder.choice.several:
                    raise several_nodes(recorder.choice.several)
                _write(recorder, bag, recorder.settled())
                if empty and bag.count:
                    empty, end = False, now + options.duration
                files.update(now)
                display.update(now)
                if now >= end:
                    break
    finally:
        recorder.stop()
    _write(recorder, bag, None)


class _Files:
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
    """Shows the progress of a recording, and why there is none."""

    def __init__(self, options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
                 begin: float) -> None:
        self._options, self._recorder, self._bag, self._begin = options, recorder, bag, begin
        self._console, self._shown = Console(stderr=True), ''
        self._title = f'recording into {escape(printable(bag.folder))}'
        self._status = self._console.status(self._title)

    def __enter__(self) -> None:
        """Show the display."""
        self._status.start()

    def __exit__(self, *_: object) -> None:
        """Remove the display."""
        self._status.stop()

    def update(self, now: float) -> None:
        """Show the present counts, and a reason for an empty bag once."""
        bag = self._bag
        self._status.update(f'{self._title}: {bag.count:,} messages of {len(bag.counts())} '
                            f'topics, {now - self._begin:.0f} s')
        if not bag.count and now - self._begin > NOTHING_TIMEOUT:
            reason = _nothing(self._options, self._recorder)
            if reason != self._shown:
                self._console.print(escape(f'bahrs record: {reason}'), soft_wrap=True)
                self._shown = reason


def _write(recorder: Recorder, bag: BagWriter, until: int | None) -> None:
    topics = recorder.new_topics()
    if topics:
        bag.add_topics(topics)
    for log_time, topic, data, publish_time in recorder.drain(until):
        bag.write(topic, log_time, data, publish_time)
    bag.flush()


def _nothing(options: argparse.Namespace, recorder: Recorder) -> str:
    """Return why no message arrives."""
    if not recorder.node_seen:
        return f'there is no {recorder.choice.selection}: start the driver, or name it with --node'
    if options.raw_only:
        return (f'the driver does not publish {RAW}: start it with '
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
    for topic, number in sorted(counts.items()):
        print(f'{printable(topic):<32}{number:>12,}')
    for sentence in _warnings(recorder):
        print(f'bahrs record: {sentence}', file=sys.stderr)
    if counts and not any(topic.endswith(f'/{RAW}') for topic in counts):
        print(f'this bag cannot be converted later, without {RAW}: start the driver with '
              '-p publish.raw:=true', file=sys.stderr)


def _warnings(recorder: Recorder) -> Iterator[str]:
    """Yield sentences about messages missing from the bag."""
    missed = sum(number for topic, number in recorder.missed.items() if topic not in REPEATED)
    if missed:
        yield (f'{missed} messages were published before driver and recorder were connected: '
               'start the driver with -p startup.wait_for_subscribers:=10')
    if recorder.lost:
        yield f'{recorder.lost} messages were lost in transport: the machine is too busy'
    if recorder.dropped:
        yield (f'{recorder.dropped} messages were not written: the disk is too slow, choose '
               'another, or record with --raw-only')
    yield from recorder.clock_steps
    yield from recorder.notes
