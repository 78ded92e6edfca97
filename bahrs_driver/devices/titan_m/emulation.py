# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs emulate --sensor titan_m`: the options of an emulated Titan-M."""

import argparse

from bahrs_driver.emulator.ground_path import GroundPath
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.emulator.titan_m.device import TitanBehavior, TitanDevice
from bahrs_driver.emulator.titan_m.measurements import TitanMeasurements, WEEK_MS
from bahrs_driver.process.argument_types import argument_type, bounded_float
from bahrs_driver.process.text_values import number, whole
from bahrs_driver.protocol.titan_m.messages import Gps, Sensors, State
from bahrs_driver.units import BITS_PER_BYTE

START = (47.2603, 11.3439)          # degrees, of a runway
OUTPUT_RATES = {Sensors: 50.0, State: 50.0, Gps: 10.0}      # Hz, into a file
NORTHERNMOST = 80.0                 # degrees, of the start of a flight


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that only this device has."""
    group = parser.add_argument_group('device: titan_m')
    group.add_argument('--start', type=argument_type(_start), default=START, metavar='LAT,LON',
                       help='start of the motion, in degrees (default: {:g},{:g})'.format(
                           *START))
    group.add_argument('--payload-order', choices=('little', 'big'), default='little',
                       help='byte order of payloads (default: %(default)s)')
    group.add_argument('--checksum-order', choices=('big', 'little'), default='big',
                       help='byte order of the checksum of answers (default: %(default)s)')
    group.add_argument('--request-order', choices=('auto', 'big', 'little'), default='auto',
                       help='byte order that the device requires in the checksum of a request; '
                            'auto accepts both (default: %(default)s)')
    group.add_argument('--sensors-len', choices=('0x3A', '0x2E'), default='0x3A',
                       help='LEN of the sensor answer: the length of its payload, or the value '
                            'in the protocol document (default: %(default)s)')
    group.add_argument('--answer-id', choices=('same', 'zero'), default='same',
                       help='message id of an answer: the same as in its request, or zero '
                            '(default: %(default)s)')
    group.add_argument('--answer-delay', type=bounded_float('a delay', 0, 10_000), default=0.5,
                       metavar='MS', help='delay from request to answer (default: %(default)s)')
    group.add_argument('--late-answers', type=bounded_float('a share', 0, 1), default=0.0,
                       metavar='SHARE', help='fraction of answers that take 0.1 s (default: 0)')
    group.add_argument('--first-fix', type=bounded_float('a time', 0, 1e6), default=0.0,
                       metavar='SECONDS', help='time from power-on to first GPS fix (default: 0)')
    group.add_argument('--gps-start', type=argument_type(_gps_time), default=0, metavar='MS',
                       help='GPS time of week at the start (default: 0)')


def make_device(options: argparse.Namespace, motion: Motion, errors: MeasurementErrors,
                _start_time: StartTime) -> TitanDevice:
    """Return the device that the options describe; into a file it sends without requests."""
    behavior = TitanBehavior(
        payload_order=options.payload_order, checksum_order=options.checksum_order,
        request_order=options.request_order, sensors_length=int(options.sensors_len, 16),
        returns_id=options.answer_id == 'same', answer_delay=options.answer_delay / 1000,
        late_share=options.late_answers, first_fix=options.first_fix,
        unrequested=OUTPUT_RATES if options.output else {})
    measurements = TitanMeasurements(GroundPath(motion, *options.start), errors, options.gps_start)
    return TitanDevice(behavior, measurements, BITS_PER_BYTE / options.baud_rate, options.seed)


def _start(text: str) -> tuple[float, float]:
    words = text.split(',')
    if len(words) != 2:
        raise ValueError(f'the start is {text!r}: it must be a latitude and a longitude in '
                         'degrees, such as 47.26,11.34')
    return (number(words[0], 'the latitude of the start', -NORTHERNMOST, NORTHERNMOST),
            number(words[1], 'the longitude of the start', -180, 180))


def _gps_time(text: str) -> int:
    return whole(text, 'the GPS time', 0, WEEK_MS - 1)
