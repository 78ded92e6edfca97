# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What verbs that are nodes of ROS share: their names and their start."""

import argparse
from collections.abc import Callable, Iterator
import contextlib
from typing import TypeVar

from bahrs_driver.cli.errors import CommandError
from bahrs_driver.ros_start import init_ros, start_errors
import rclpy
from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name

T = TypeVar('T')

_kept: list[object] = []


def checked_namespace(text: str) -> str:
    """Return a namespace as /left, or nothing for the outermost; CommandError if it is none."""
    name = text.strip('/')
    try:
        validate_namespace(f'/{name}')
    except InvalidNamespaceException as error:
        raise CommandError(f'{text!r} is no namespace: it must be a name such as '
                           '/left') from error
    return f'/{name}' if name else ''


def check_node_name(text: str) -> None:
    """Raise CommandError if a text is no name of a node."""
    try:
        validate_node_name(text)
    except InvalidNodeNameException as error:
        raise CommandError(f'{text!r} is no name of a node: it must have letters, digits and _ '
                           'only, and its namespace goes into --namespace') from error


@contextlib.contextmanager
def ros_session(options: argparse.Namespace) -> Iterator[Callable[[T], T]]:
    """
    Run a block with ROS initialised by the words after --ros-args; RosStartError if it cannot.

    The block gets a function that keeps what has a node until the process ends: destroying a node
    may hang after the host clock was set back, and main() limits only the time of that end. Verbs
    write no log files: each run would leave one, empty.
    """
    with start_errors(options.ros_arguments):
        init_ros(options.ros_arguments, log_files=False)
    try:
        yield _keep
    finally:
        rclpy.try_shutdown()


def _keep(thing: T) -> T:
    _kept.append(thing)
    return thing
