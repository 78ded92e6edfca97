# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs nvm`: read the non-volatile memory of a device, and show its content."""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
import contextlib
from dataclasses import asdict, fields
import hashlib
import json
import math
import sys
import threading

from bahrs_driver.cli.files import binary_input
from bahrs_driver.cli.outputs import add_force, is_standard_output, output_file
from bahrs_driver.cli.progress import progress_bar
from bahrs_driver.cli.signals import shutdown_on_signal
from bahrs_driver.devices.nvm_reader import NvmReader, OnProgress, SessionOptions
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.errors import CommandError, NvmError
from bahrs_driver.pipeline import DecodingFault, Event, Stamped
from bahrs_driver.process.argument_types import bounded_float
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.memory import FoundBlock, MemoryFormat
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_events import Decoded, PortEvent, PortOpened, PortUnavailable
from bahrs_driver.transport.port_reader import PortReader

LONGEST_ENTER = 600     # s
OPEN_TIME = 30.0        # s until the port is open or has failed
LISTEN_TIME = 3.0       # s until a device that streams has sent a sample, even if it just starts
ERASED = '\xff'         # byte of erased memory
_MEMORIES: dict[str, MemoryFormat] = {
    name: spec.memory for name, spec in DEVICES.items() if spec.memory}

_EXAMPLES = (
    'bahrs nvm read 0 --port /dev/ttyUSB0',
    'bahrs nvm dump device.bin --port /dev/ttyUSB0',
    'bahrs nvm show device.bin')


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Read the pages of the memory; nothing is written to it. While it is read, the device\n'
        'is in diagnostics mode and sends no data.')
    parser.epilog = '\n  '.join(('examples:', *_EXAMPLES))
    actions = parser.add_subparsers(dest='action', metavar='ACTION', required=True)
    read = actions.add_parser('read', help='print one page in hexadecimal')
    read.add_argument('page', type=int, help='number of the page, from 0 on')
    dump = actions.add_parser('dump', help='write all pages into a file')
    dump.add_argument('file', help='file to write, complete or not at all; - is standard output')
    add_force(dump)
    for action in (read, dump):
        _add_port_options(action)
    show = actions.add_parser('show', help='show the content of an image')
    show.add_argument('file', help='image of the memory; - is standard input')
    for action in (read, dump, show):
        action.add_argument('--sensor', choices=tuple(_MEMORIES), default=next(iter(_MEMORIES)),
                            help='device of the memory (default: %(default)s)')
    for action in (dump, show):
        action.add_argument('--json', action='store_true',
                            help='print one JSON object, for a script')
    for action, example in ((read, _EXAMPLES[0]), (dump, _EXAMPLES[1]), (show, _EXAMPLES[2])):
        action.epilog = f'example: {example}'


def _add_port_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--port', default='/dev/ttyUSB0',
                        help='path or URL, such as socket://host:4001 (default: %(default)s)')
    parser.add_argument('--baud-rate', type=int, default=115200, metavar='BAUD',
                        help='(default: %(default)s)')
    parser.add_argument('--enter-timeout', type=bounded_float('a time-out', 0, LONGEST_ENTER),
                        default=30.0, metavar='SECONDS',
                        help='how long to ask the device to enter diagnostics mode '
                             '(default: %(default)s)')
    variants = [name for memory in _MEMORIES.values() for name in memory.request_variants]
    parser.add_argument('--service-frames', default='auto',
                        choices=tuple(dict.fromkeys(('auto', *variants))),
                        help='checksum and padding of requests (default: %(default)s)')
    parser.add_argument('--yes', action='store_true',
                        help='do not ask before a stream is stopped')


def run(options: argparse.Namespace) -> int:
    """Run the action; return 1 if an image is damaged."""
    return {'read': _read, 'dump': _dump, 'show': _show}[options.action](options)


def _read(options: argparse.Namespace) -> int:
    count = _MEMORIES[options.sensor].page_count
    if not 0 <= options.page < count:
        raise CommandError(f'page {options.page} does not exist: pages are 0 to {count - 1}')
    print(_read_pages(options, [options.page]).hex())
    return 0


def _dump(options: argparse.Namespace) -> int:
    # The file first: if it cannot be written, the stream is not stopped.
    with output_file(options.file, options.force) as file:
        image = _read_pages(options, range(_MEMORIES[options.sensor].page_count))
        file.write(image)
    digest = hashlib.sha256(image).hexdigest()
    out = sys.stderr if is_standard_output(options.file) else sys.stdout
    if options.json:
        print(json.dumps({'path': options.file, 'size': len(image), 'sha256': digest}), file=out)
    else:
        print(f'{printable(options.file)}: {len(image):,} bytes, SHA-256 {digest}', file=out)
    return 0


def _read_pages(options: argparse.Namespace, wanted: Sequence[int]) -> bytes:
    with _device(options) as device:
        if device.streams(LISTEN_TIME) and not options.yes:
            _confirm()
        with progress_bar() as progress:
            task = progress.add_task('', total=1.0)
            pages = _read_until_signal(
                device.nvm, wanted,
                SessionOptions(options.enter_timeout, options.service_frames),
                lambda session: progress.update(task, completed=session.progress,
                                                description=session.description))
    return b''.join(pages[number] for number in wanted)


def _read_until_signal(reader: NvmReader, wanted: Sequence[int], options: SessionOptions,
                       on_progress: OnProgress) -> dict[int, bytes]:
    """Return pages; at a signal leave diagnostics mode and raise KeyboardInterrupt."""
    with shutdown_on_signal() as ended, ThreadPoolExecutor(1) as pool:
        pages = pool.submit(reader.read, wanted, options, on_progress=on_progress)
        pages.add_done_callback(lambda _: ended.set())
        ended.wait()
        if not pages.done():
            reader.end('interrupted')
            raise KeyboardInterrupt
        try:
            return pages.result()
        except NvmError as error:
            raise CommandError(str(error)) from error


def _confirm() -> None:
    if not sys.stdin.isatty():
        raise CommandError('reading the memory stops the stream of the device: add --yes')
    print('The device streams. Reading its memory stops that for some seconds. Continue? [y/N] ',
          end='', file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() not in ('y', 'yes'):
        raise CommandError('cancelled: the memory was not read')


class Device:
    """A device on a port, whose stream a thread reads while another one reads its memory."""

    def __init__(self, spec: AnyDevice, link: Link, port: str) -> None:
        pipeline, self.nvm = spec.memory_access(link)
        self.failure = ''
        self._port = port
        self._faults = FaultLog(_print_error, str)
        self._reader = PortReader(link, pipeline, self._faults)
        self._sample = spec.roles.sample if spec.roles else ()
        self._opened = threading.Event()
        self._streams = threading.Event()
        self.threads = [threading.Thread(target=self._read, name='reader'),
                        threading.Thread(target=self.nvm.loop.run, name='requests')]

    def stop(self) -> None:
        """Make the threads end soon."""
        self._reader.stop()
        self.nvm.loop.stop()

    def streams(self, timeout: float) -> bool:
        """Wait for the port (CommandError if it fails); return whether data arrives in time."""
        if not self._opened.wait(OPEN_TIME):
            raise CommandError(f'{printable(self._port)} could not be opened within '
                               f'{OPEN_TIME:g} s: check other programs and the network')
        if self.failure:
            raise CommandError(self.failure)
        return self._streams.wait(timeout)

    def _read(self) -> None:
        for event in self._reader.events():
            self._faults.survive('handling an event of the port', self._handle, event)

    def _handle(self, event: PortEvent) -> None:
        if isinstance(event, PortOpened):
            self._opened.set()
        elif isinstance(event, PortUnavailable):
            self.failure = event.reason
            self._opened.set()
            self.nvm.abandon(event.reason)
        elif isinstance(event, Decoded):
            for item in event.events:
                self._receive(item)

    def _receive(self, item: Event) -> None:
        if isinstance(item, DecodingFault):
            self._faults.report('decoding a frame', item.error)
        elif isinstance(item, Stamped):
            if isinstance(item.message, self._sample):
                self._streams.set()
            self.nvm.receive(item.message, item.frame)


def _print_error(sentence: str) -> None:
    print(f'bahrs nvm: {sentence}', file=sys.stderr)


@contextlib.contextmanager
def _device(options: argparse.Namespace) -> Iterator[Device]:
    try:
        link = Link(options.port, options.baud_rate)
        device = Device(DEVICES[options.sensor], link, options.port)
    except ValueError as error:
        raise CommandError(f'{options.port} cannot be opened: {error}') from error
    for thread in device.threads:
        thread.start()
    try:
        yield device
    finally:
        device.stop()
        for thread in device.threads:
            thread.join()


def _show(options: argparse.Namespace) -> int:
    memory = _MEMORIES[options.sensor]
    with binary_input(options.file) as file:
        image = file.read(memory.size + 1)
    if len(image) > memory.size:
        raise CommandError(f'{options.file} is not an image: an image has {memory.size:,} bytes')
    try:
        blocks = list(memory.parse(image))
    except ValueError as error:
        raise CommandError(f'{options.file} is not an image: {error}') from error
    if options.json:
        print(json.dumps({found.block.NAME: {
            'intact': found.intact,
            **{name: _json_value(value) for name, value in asdict(found.block).items()}}
            for found in blocks}))
    else:
        for found in blocks:
            _print_block(found)
    complaint = memory.complain(blocks)
    if complaint:
        print(f'bahrs nvm: {complaint}', file=sys.stderr)
    damaged = [found.block.NAME for found in blocks if found.intact is False]
    if damaged:
        print(f"bahrs nvm: damaged: {', '.join(damaged)}", file=sys.stderr)
    return bool(damaged)


def _print_block(found: FoundBlock) -> None:
    block = found.block
    verdict = {True: 'CRC good', False: 'CRC BAD', None: 'no CRC'}[found.intact]
    print(f'{block.NAME} ({verdict})')
    for item in fields(block):
        value, unit = getattr(block, item.name), item.metadata['rows'][1].unit
        if isinstance(value, str):
            _print_text(value)
        else:
            print(f'  {item.name:<20}{_text(value)} {unit}'.rstrip())


def _print_text(value: str) -> None:
    text = value.rstrip(f'\n{ERASED}')
    for line in text.split('\n') if text else ['none']:
        print(f'  {printable(line, len(value) * 4 + 1)}')


def _json_value(value: object) -> object:
    """Return a value that JSON has: null in place of NaN."""
    if isinstance(value, tuple):
        return [_json_value(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _text(value: object) -> str:
    if isinstance(value, tuple):
        return ' '.join(_text(item) for item in value)
    return f'{value:.6g}' if isinstance(value, float) else str(value)
