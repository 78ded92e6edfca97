# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Start ROS. This module imports rclpy only when it is used: see `environment`."""

from collections.abc import Iterable, Mapping, Sequence
import os

from bahrs_driver.errors import RosStartError
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.environment import (
    environment_problems, EnvironmentProblem, import_problems, log_problem,
)

NO_LOG_FILES = ('--ros-args', '--disable-external-lib-logs')
_LONGEST_REASON = 300


def check_import(environment: Mapping[str, str] = os.environ) -> None:
    """Raise RosStartError if importing rclpy would end the process, or flood its output."""
    _raise_first(import_problems(environment))


def check_environment(environment: Mapping[str, str] = os.environ) -> None:
    """Raise RosStartError if ROS could not start with the variables of an environment."""
    _raise_first(environment_problems(environment))


def init_ros(arguments: Sequence[str], log_files: bool = True) -> str:
    """Initialize ROS without signal handlers; return why it writes no log files, if so."""
    check_environment()
    import rclpy
    from bahrs_driver.ros.start_errors import without_source_lines
    from rclpy.signals import SignalHandlerOptions

    def init(*more: str) -> None:
        rclpy.init(args=[*arguments, *more], signal_handler_options=SignalHandlerOptions.NO)

    # rcl would read the flag as the value of an option that lacks its own.
    no_log_files = () if arguments and arguments[-1].startswith('-') else NO_LOG_FILES
    problem = log_problem() if log_files else 'they are not wanted'
    try:
        init(*(no_log_files if problem else ()))
    except RuntimeError as error:       # the base of RCLError, which rclpy does not export
        if 'logging' not in str(error):
            raise
        rclpy.try_shutdown()        # ROS was partly initialized before the logging failed
        problem = without_source_lines(error)
        init(*no_log_files)
    return problem


def missing_module(error: ImportError) -> str:
    """Explain in a sentence why a module cannot be imported, with the remedy."""
    reason = f'the Python module {error.name} is missing' \
        if isinstance(error, ModuleNotFoundError) else printable(error, _LONGEST_REASON)
    return f'{reason}; install it, or source the set-up of your ROS 2'


def _raise_first(problems: Iterable[EnvironmentProblem]) -> None:
    for problem in problems:
        raise RosStartError(problem.message)
