# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The options of the simulated cable, for emulate and replay."""

import argparse

from bahrs_driver.process.argument_types import argument_type
from bahrs_driver.virtual_serial.cable import adapter_mode
from bahrs_driver.virtual_serial.faults import NAMES, parse_fault

FAULTS_HELP = '\n'.join([
    'faults, each with a rate from 0 to 1 per byte or frame:',
    *(f'  {name:<28}{text}' for name, text in NAMES.items())])


def add_cable_options(parser: argparse.ArgumentParser, latency_timer: str | None,
                      default_help: str) -> None:
    """Add the options; latency_timer is the default of --latency-timer."""
    group = parser.add_argument_group('cable')
    group.add_argument('--latency-timer', type=argument_type(adapter_mode), metavar='MS',
                       default=latency_timer,
                       help='time for which the adapter holds bytes back, 1 to 255 ms; "packets" '
                            'for an adapter that delivers eight full packets at a time, "none" '
                            f'for no delay (default: {default_help})')
    group.add_argument('--fault', type=argument_type(parse_fault), action='append', default=[],
                       metavar='NAME=RATE',
                       help='damage the stream, see below; repeat the option for each fault')
