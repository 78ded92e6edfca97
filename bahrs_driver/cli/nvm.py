# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs nvm`: read the non-volatile memory of a device, or show an image of it."""

import argparse
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
import hashlib
import json
import math
import sys

from bahrs_driver.cli.nvm_device import NvmDevice
from bahrs_driver.cli.nvm_image import print_json, print_text, read_image
from bahrs_driver.cli.outputs import add_force, is_standard_output, output_file
from bahrs_driver.cli.printing import warn
from bahrs_driver.cli.progress import progress_bar
from bahrs_driver.cli.signals import shutdown_on_signal
from bahrs_driver.devices.nvm_reader import NvmReader, OnProgress
from bahrs_driver.devices.nvm_settings import NvmSettings
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import CommandError
from bahrs_driver.process.argument_types import bounded_float
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.memory import MemoryFormat
from bahrs_driver.settings.group import parameters
from bahrs_driver.transport.link import Link

LISTEN_TIME = 3.0       # s in which a streaming device sends a sample, even if it just starts
_MEMORIES: dict[str, MemoryFormat] = {
    name: spec.memory for name, spec in DEVICES.items() if spec.memory}
_SETTINGS = {parameter.name: parameter for parameter in parameters(NvmSettings())}

_EXAMPLES = {
    'read': 'bahrs nvm read 0 --port /dev/ttyUSB0',
    'dump': 'bahrs nvm dump device.bin --port /dev/ttyUSB0',
    'show': 'bahrs nvm show device.bin'}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Read the non-volatile memory of a device, page by page. The memory is never written.\n'
        'During the reading, the device is in diagnostics mode and sends no data.')
    parser.epilog = '\n  '.join(('examples:', *_EXAMPLES.values()))
    actions = parser.add_subparsers(dest='action', metavar='ACTION', required=True)
    read = actions.add_parser('read', help='print one page in hexadecimal')
    read.add_argument('page', type=int, help='page number; the first page is 0')
    dump = actions.add_parser('dump', help='write all pages to a file')
    dump.add_argument('file', help='file to create when complete; - is standard output')
    add_force(dump)
    for action in (read, dump):
        _add_port_options(action)
    show = actions.add_parser('show', help='show the content of an image')
    show.add_argument('file', help='file written by dump; - is standard input')
    for action in (read, dump, show):
        action.add_argument('--sensor', choices=tuple(_MEMORIES), default=next(iter(_MEMORIES)),
                            help='device that has the memory (default: %(default)s)')
    for action in (dump, show):
        action.add_argument('--json', action='store_true',
                            help='print the result as one JSON object')
    for name, action in actions.choices.items():
        action.epilog = f'example: {_EXAMPLES[name]}'


def _add_port_options(parser: argparse.ArgumentParser) -> None:
    enter_timeout, service_frames = _SETTINGS['enter_timeout'], _SETTINGS['service_frames']
    parser.add_argument('--port', default='/dev/ttyUSB0',
                        help='path or URL, such as socket://host:4001 (default: %(default)s)')
    parser.add_argument('--baud-rate', type=int, default=115200, metavar='BAUD',
                        help='speed of the serial line (default: %(default)s)')
    parser.add_argument('--enter-timeout', default=enter_timeout.default, metavar='SECONDS',
                        type=bounded_float('a time-out', high=enter_timeout.high or math.inf),
                        help='time limit for the device to enter diagnostics mode, which many do '
                             'only at power-on (default: %(default)g)')
    parser.add_argument('--service-frames', default=service_frames.default,
                        choices=service_frames.choices,
                        help='checksum and padding of requests (default: %(default)s, tries all)')
    parser.add_argument('--yes', action='store_true',
                        help='interrupt the stream of the device without confirmation')


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
    # Open the file first: if that fails, the stream need not be interrupted.
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


def _show(options: argparse.Namespace) -> int:
    memory = _MEMORIES[options.sensor]
    blocks = read_image(options.file, memory)
    (print_json if options.json else print_text)(blocks)
    damaged = ', '.join(found.block.NAME for found in blocks if found.intact is False)
    if complaint := memory.complain(blocks):
        warn('nvm', complaint)
    if damaged:
        warn('nvm', f'damaged: {damaged}')
    return int(bool(damaged))


def _read_pages(options: argparse.Namespace, numbers: Sequence[int]) -> bytes:
    try:
        link = Link(options.port, options.baud_rate)
    except ValueError as error:
        raise CommandError(f'{options.port} cannot be opened: {error}') from error
    device = NvmDevice(DEVICES[options.sensor], link, partial(warn, 'nvm'))
    settings = NvmSettings(enter_timeout=options.enter_timeout,
                           service_frames=options.service_frames)
    with device.running():
        if device.is_streaming(LISTEN_TIME) and not options.yes:
            _confirm()
        with progress_bar() as progress:
            task = progress.add_task('', total=1.0)
            pages = _read_until_signal(
                device.nvm, numbers, settings,
                lambda session: progress.update(task, completed=session.progress,
                                                description=session.description))
    return b''.join(pages[number] for number in numbers)


def _read_until_signal(reader: NvmReader, numbers: Sequence[int], settings: NvmSettings,
                       on_progress: OnProgress) -> dict[int, bytes]:
    """Return pages; at a signal leave diagnostics mode and raise KeyboardInterrupt."""
    with shutdown_on_signal() as done_or_signal, ThreadPoolExecutor(1) as pool:
        pages = pool.submit(reader.read, numbers, settings, on_progress=on_progress)
        pages.add_done_callback(lambda _: done_or_signal.set())
        done_or_signal.wait()
        if not pages.done():
            reader.end('interrupted')
            raise KeyboardInterrupt
        return pages.result()


def _confirm() -> None:
    if not sys.stdin.isatty():
        raise CommandError('reading the memory interrupts the stream of the device: confirm with '
                           '--yes')
    print('The device is streaming. Reading its memory interrupts the stream for some seconds. '
          'Continue? [y/N] ', end='', file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() not in ('y', 'yes'):
        raise CommandError('cancelled: the memory was not read')
