# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs emulate --sensor bahrs`: the options of an emulated BAHRS."""

import argparse

from bahrs_driver.emulator.bahrs.device import BahrsBehavior, BahrsDevice, START_UPS
from bahrs_driver.emulator.bahrs.diagnostics_mode import INACTIVITY_TIMEOUT, ServiceBehavior
from bahrs_driver.emulator.bahrs.nvm_image import example_image, SIZE
from bahrs_driver.emulator.bahrs.pulses import Pulses
from bahrs_driver.emulator.device_clock import DeviceClock
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.process.argument_types import argument_type, bounded_float, open_input
from bahrs_driver.process.text_values import whole
from bahrs_driver.protocol.bahrs.messages import VERSIONS
from bahrs_driver.protocol.bahrs.nvm_session import PAGES
from bahrs_driver.units import NS_PER_S


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that only this device has."""
    _add_device(parser)
    _add_service(parser)


def make_device(options: argparse.Namespace, motion: Motion, errors: MeasurementErrors,
                start_time: StartTime) -> BahrsDevice:
    """Return the device that the options describe."""
    behavior = BahrsBehavior(
        options.protocol_version, options.crc, options.time_label, options.start_up,
        options.debug_rate, options.output_delay / 1000, _service(options))
    clock = DeviceClock(options.seed, options.drift_ppm, options.wander_ppm, options.clock_start)
    pulses = Pulses(options.sync_pulse_rate, origin=-(start_time.unix_ns % NS_PER_S) / NS_PER_S)
    return BahrsDevice(behavior, motion, errors, clock, pulses)


def _add_device(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('device: bahrs')
    group.add_argument('--protocol-version', type=int, choices=VERSIONS, default=3,
                       help='protocol version of the device (default: %(default)s)')
    group.add_argument('--crc', choices=('word', 'byte'), default='word',
                       help='CRC over 32-bit words (real devices) or single bytes (protocol '
                            'document) (default: %(default)s)')
    group.add_argument('--time-label', choices=('next', 'same'), default='next',
                       help='a time message names the sample after the one whose time it holds '
                            '(real devices) or that sample (default: %(default)s)')
    group.add_argument('--start-up', choices=tuple(START_UPS), default='prompt',
                       help='first sample 0.6 s after power-on, or as recorded: 2.6 s, then '
                            '2.7 s of silence (default: %(default)s)')
    group.add_argument('--drift-ppm', type=bounded_float('a drift', -1e5, 1e5), default=0.0,
                       metavar='PPM',
                       help='drift of the device clock, positive if it is fast (default: 0)')
    group.add_argument('--wander-ppm', type=bounded_float('a wander', 0, 1e3), default=0.0,
                       metavar='PPM', help='random walk of the drift, per square root of a '
                                           'second (default: 0)')
    group.add_argument('--clock-start', type=argument_type(_device_time), default=0, metavar='US',
                       help='device time at power-on, in microseconds (default: 0)')
    group.add_argument('--sync-pulse-rate', type=bounded_float('a rate', 0, 1000), default=0.0,
                       metavar='HZ', help='rate of sync pulses, at whole multiples of the period '
                                          'in UNIX time; the device ignores a pulse within 90 ms '
                                          'of the previous one (default: 0, none)')
    group.add_argument('--debug-rate', type=bounded_float('a rate', 0, 200), default=0.0,
                       metavar='HZ',
                       help='rate of the undocumented messages 0xC0 and 0xC1 (default: 0)')
    group.add_argument('--output-delay', type=bounded_float('a delay', 0, 1000), default=0.0,
                       metavar='MS', help='delay from a sample to its first byte (default: 0)')


def _add_service(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('diagnostics mode: bahrs')
    group.add_argument('--nvm', type=argument_type(_image), metavar='FILE',
                       help=f'image of the memory, {SIZE:,} bytes (default: an example)')
    group.add_argument('--nvm-window', choices=('always', 'power-on'), default='always',
                       help='when the device accepts a request to enter: always, or only within '
                            '0.5 s of power-on, as known firmware does (default: %(default)s)')
    group.add_argument('--nvm-error-pages', type=argument_type(_pages), default=frozenset(),
                       metavar='PAGE[,PAGE...]', help='pages that cannot be read (default: none)')
    group.add_argument('--nvm-timeout', type=bounded_float('a time-out'),
                       default=INACTIVITY_TIMEOUT, metavar='SECONDS',
                       help='time without a request after which the device leaves the mode '
                            '(default: %(default)g)')
    group.add_argument('--service-crc', choices=('crc32', 'mpeg2'), default='crc32',
                       help="CRC of service frames: CRC-32 (manufacturer's tool) or CRC-32/MPEG-2 "
                            '(protocol document) (default: %(default)s)')
    group.add_argument('--service-padding', choices=('no', 'yes'), default='no',
                       help="whether 0xF0 and 0xF1 must be padded: no (manufacturer's tool) or "
                            'yes (protocol document) (default: %(default)s)')


def _service(options: argparse.Namespace) -> ServiceBehavior:
    return ServiceBehavior(
        'crc32' if options.service_crc == 'crc32' else 'byte', options.service_padding == 'yes',
        options.nvm_window, options.nvm_error_pages, options.nvm or example_image(),
        options.nvm_timeout)


def _device_time(text: str) -> int:
    return whole(text, 'the device time', 0, 2 ** 62)


def _pages(text: str) -> frozenset[int]:
    return frozenset(whole(word, 'a page', 0, PAGES - 1) for word in text.split(','))


def _image(name: str) -> bytes:
    with open_input(name, 'rb') as file:
        image: bytes = file.read(SIZE + 1)
    if len(image) != SIZE:
        size = f'{len(image):,} bytes' if len(image) < SIZE else 'more bytes'
        raise ValueError(f'{name} has {size}: an image has {SIZE:,}')
    return image
