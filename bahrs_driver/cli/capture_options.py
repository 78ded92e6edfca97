# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The options that describe a recording: a bag with the topic raw, or a file of raw bytes."""

import argparse

from bahrs_driver.devices.registry import DEFAULT, DEVICES


def add_topic_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that selects a topic of a bag."""
    parser.add_argument('--topic', metavar='NAME',
                        help='topic with the raw bytes, if the bag has several')


def add_sensor_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that overrides the device which a bag names."""
    parser.add_argument('--sensor', choices=tuple(DEVICES),
                        help='device that sent the bytes (default: the one that the bag names, or '
                             f'{DEFAULT})')
