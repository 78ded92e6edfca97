# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs record`: the driver's topics into a bag."""

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
from bahrs_driver.cli.ros import ros_session
from bahrs_driver.cli.signals import shutdown_on_signal
from bahrs_driver.errors import CommandError, TargetExists, WriteError
from bahrs_driver.process.argument_types import positive_float
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.process.printable import printable
from bahrs_driver.process.shutdown_event import ShutdownEvent
from bahrs_driver.ros.start_errors import start_errors
from rich.console import Console
from rich.markup import escape

WRITE_PERIOD = 0.25             # s; a kill costs this and what the recorder holds back
SYNC_PERIOD = 1.0               # s; the most that a loss of power costs, with what the disk holds
PATIENCE = 5.0                  # s until the user is told that nothing is there to record
FIRST_WAIT = 30.0       # s for the first message, if there is a duration
MEGABYTE = 1_000_000
REPEATED = ('/diagnostics', '/rosout')      # topics whose first messages are no data

_EXAMPLES = """examples:
  bahrs record                              all topics of the driver, until Ctrl-C
  bahrs record --raw-only --output flight   only the bytes: convert them later
  bahrs record --max-size 500 --duration 3600 --json
  ros2 bag play flight
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Record all topics of the driver into a rosbag2 directory (MCAP), those that appear\n'
        'later, too. Whatever ends it, all but the last second can be read. Ctrl-C is the usual\n'
        'way, with exit status 0.')
    parser.epilog = _EXAMPLES
    parser.add_argument('-o', '--output', metavar='DIRECTORY',
                        help='bag to make (default: bahrs_ and the time)')
    parser.add_argument('--raw-only', action='store_true',
                        help='only the topic raw, which the driver publishes with '
                             'publish.raw:=true; "bahrs convert" makes the others of it')
    parser.add_argument('--max-size', type=positive_float, default=math.inf, metavar='MB',
                        help='begin another file at this size (default: never)')
    parser.add_argument('--max-duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='begin another file after this time (default: never)')
    parser.add_argument('--duration', type=positive_float, default=math.inf, metavar='SECONDS',
                        help='end after this time of data, or if none comes for '
                             f'{FIRST_WAIT:g} s (default: at Ctrl-C)')
    add_node_options(parser)
    parser.add_argument('--json', action='store_true',
                        help='print what was recorded as a JSON object at the end')


def run(options: argparse.Namespace) -> int:
    """Record until the time is up or a signal ends it; 1 if there was nothing, or no room."""
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
        raise CommandError(f'recording was stopped: {failure}; the bag has all that came before')
    if not bag.count:
        raise CommandError(f'{printable(bag.folder)} is empty: {_nothing(options, recorder)}')
    return 0


def new_bag(output: str | None) -> BagWriter:
    """Make the bag that is named, or one under a name that is free."""
    base = output or time.strftime('bahrs_%Y_%m_%d-%H_%M_%S')
    for folder in chain([base], (f'{base}_{number}' for number in count(2))):
        try:
            return BagWriter(folder)
        except TargetExists:
            if output:
                raise
    raise AssertionError('there are always more names')


def _record(options: argparse.Namespace, recorder: Recorder, bag: BagWriter,
            ended: ShutdownEvent) -> None:
    """Write what comes, until ended."""
    begin = file_begin = synced = time.monotonic()
    end, shown, empty = begin + max(options.duration, FIRST_WAIT), '', True
    console, doing = Console(stderr=True), f'recording into {escape(printable(bag.folder))}'
    try:
        with console.status(doing) as status:
            while not ended.wait(min(WRITE_PERIOD, max(0.0, end - time.monotonic()))):
                now = time.monotonic()
                if recorder.choice.several:
                    raise several_nodes(recorder.choice.several)
                _write(recorder, bag, recorder.settled())
                if empty and bag.count:
                    empty, end = False, now + options.duration
                if now >= synced + SYNC_PERIOD:
                    bag.sync()
                    synced = now
                if bag.size >= options.max_size * MEGABYTE or \
                        now - file_begin >= options.max_duration:
                    bag.split()
                    file_begin = now
                status.update(f'{doing}: {bag.count:,} messages of {len(bag.counts())} topics, '
                              f'{now - begin:.0f} s')
                if not bag.count and now - begin > PATIENCE:
                    reason = _nothing(options, recorder)
                    if reason != shown:
                        console.print(escape(f'bahrs record: {reason}'), soft_wrap=True)
                        shown = reason
                if now >= end:
                    break
    finally:
        recorder.stop()
    _write(recorder, bag, None)


def _write(recorder: Recorder, bag: BagWriter, until: int | None) -> None:
    topics = recorder.new_topics()
    if topics:
        bag.add_topics(topics)
    for log_time, topic, data, publish_time in recorder.drain(until):
        bag.write(topic, log_time, data, publish_time)
    bag.flush()


def _nothing(options: argparse.Namespace, recorder: Recorder) -> str:
    """Return why nothing comes."""
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
    for sentence in _complaints(recorder):
        print(f'bahrs record: {sentence}', file=sys.stderr)
    if counts and not any(topic.endswith(f'/{RAW}') for topic in counts):
        print(f'without {RAW} it cannot be converted later: start the driver with '
              '-p publish.raw:=true for that', file=sys.stderr)


def _complaints(recorder: Recorder) -> Iterator[str]:
    """Return what the user should know of the bag."""
    missed = sum(number for topic, number in recorder.missed.items() if topic not in REPEATED)
    if missed:
        yield (f'{missed} messages were published before driver and recorder had found each '
               'other: start the driver with -p startup.wait_for_subscribers:=10')
    if recorder.lost:
        yield f'{recorder.lost} messages were lost on the way: the machine is too busy'
    if recorder.dropped:
        yield (f'{recorder.dropped} messages were not written: the disk is too slow, choose '
               'another, or record with --raw-only')
    yield from recorder.clock_steps
    yield from recorder.notes
