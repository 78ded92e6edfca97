# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Start and stop ROS for verbs that are nodes."""

import argparse
from collections.abc import Callable, Iterator
import contextlib
from typing import TypeVar

from bahrs_driver.ros.start import init_ros
from bahrs_driver.ros.start_errors import start_errors
import rclpy

T = TypeVar('T')

_kept: list[object] = []


@contextlib.contextmanager
def ros_session(options: argparse.Namespace) -> Iterator[Callable[[T], T]]:
    """
    Run a block with ROS initialized by the words after --ros-args; RosStartError if it fails.

    The block gets a function that keeps an object with a node until the process ends: destroying a
    node may hang after the host clock was set back, and main() limits only the time of the exit.
    Verbs write no log files: each run would leave an empty one.
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
