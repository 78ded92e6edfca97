# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start ROS, or explain in one sentence why it cannot start.

Some values of the environment make ROS end the process without an exception: an unknown
RMW_IMPLEMENTATION does so when rclpy is imported. So this module checks them first, and imports
rclpy only in functions.
"""

from collections.abc import Iterator, Mapping, Sequence
import contextlib
import os
from pathlib import Path
import sys
import tempfile
import warnings

from bahrs_driver.errors import RosStartError
from bahrs_driver.process.printable import printable

HIGHEST_DOMAIN = 232            # the ports of a higher one would be beyond 65535
SAFE_DOMAIN = 101               # the ports of a higher one can be ephemeral ports of Linux
CHOOSER = 'rmw_implementation'  # loads a middleware, and is none itself
SWITCHES = ('RCUTILS_COLORIZED_OUTPUT', 'RCUTILS_LOGGING_USE_STDOUT',
            'RCUTILS_LOGGING_BUFFERED_STREAM')
NO_LOG_FILES = ('--ros-args', '--disable-external-lib-logs')
_MIDDLEWARES = 'share/ament_index/resource_index/rmw_typesupport'
_LONGEST_REASON = 300


def middlewares(environment: Mapping[str, str], python: Path = Path(sys.prefix)) -> list[str]:
    """Return the installed middlewares; an empty list if none can be found."""
    prefixes = [Path(item) for item in environment.get('AMENT_PREFIX_PATH', '').split(':') if item]
    found: set[str] = set()
    for prefix in prefixes or [python]:
        with contextlib.suppress(OSError, ValueError):      # a prefix may be any text
            found.update(os.listdir(prefix / _MIDDLEWARES))
    return sorted(name for name in found if name.startswith('rmw_') and name != CHOOSER)


def check_import(environment: Mapping[str, str] = os.environ) -> None:
    """Raise RosStartError if importing rclpy would end the process, or flood its output."""
    chosen, installed = environment.get('RMW_IMPLEMENTATION', ''), middlewares(environment)
    if chosen and installed and chosen not in installed:
        raise RosStartError(f'RMW_IMPLEMENTATION is {_quoted(chosen)}, which is not installed: '
                            f'unset it, or set it to {" or ".join(installed)}')
    for name in SWITCHES:
        if environment.get(name, '') not in ('', '0', '1'):
            raise RosStartError(f'{name} is {_quoted(environment[name])}: it must be 0 or 1')


def check_environment(environment: Mapping[str, str] = os.environ) -> None:
    """Raise RosStartError if ROS could not start with the variables of an environment."""
    check_import(environment)
    if not valid_domain(text := environment.get('ROS_DOMAIN_ID', ''), HIGHEST_DOMAIN):
        raise RosStartError(f'ROS_DOMAIN_ID is {_quoted(text)}: it must be a number from 0 to '
                            f'{SAFE_DOMAIN}')


def valid_domain(text: str, highest: int) -> bool:
    """Return whether a text is a domain up to a number, or empty for the default domain."""
    return not text or (text.isascii() and text.isdecimal() and len(text) < 10
                        and int(text) <= highest)


def log_directory(environment: Mapping[str, str] = os.environ) -> str:
    """Return the directory of the ROS log files; it begins with ~ if HOME is not set."""
    text = environment.get('ROS_LOG_DIR') or \
        os.path.join(environment.get('ROS_HOME') or '~/.ros', 'log')
    home = environment.get('HOME', '')
    return home + text[1:] if home and text.startswith('~') else text


def log_problem(environment: Mapping[str, str] = os.environ) -> str:
    """Return why ROS cannot write log files; empty if it can. Leave no file behind."""
    folder = log_directory(environment)
    if folder.startswith('~'):
        return f'{_quoted(folder)} needs HOME, which is not set'
    directory = Path(os.path.abspath(folder))
    try:
        while not directory.exists():
            directory = directory.parent
    except (OSError, ValueError) as error:
        return f'{_quoted(folder)} cannot be used: {printable(error)}'
    if not directory.is_dir():
        return f'{_quoted(folder)} cannot be made: {_quoted(directory)} is no directory'
    try:
        # Permissions are not enough: a file system may be full, or hold no files.
        with tempfile.TemporaryFile(dir=directory):
            return ''
    except OSError as error:
        return f'{_quoted(directory)} cannot be written: {printable(error.strerror)}'


def init_ros(arguments: Sequence[str], log_files: bool = True) -> str:
    """Initialize ROS without signal handlers; return why it writes no log files, or nothing."""
    check_environment()
    import rclpy
    from bahrs_driver.settings.start_errors import without_places
    from rclpy.signals import SignalHandlerOptions

    def init(*more: str) -> None:
        rclpy.init(args=[*arguments, *more], signal_handler_options=SignalHandlerOptions.NO)

    # A flag that lacks its value would consume the next argument.
    without = () if arguments and arguments[-1].startswith('-') else NO_LOG_FILES
    problem = log_problem() if log_files else 'they are not wanted'
    try:
        init(*(without if problem else ()))
    except RuntimeError as error:       # the base of RCLError, which rclpy does not export
        if 'logging' not in str(error):
            raise
        rclpy.try_shutdown()        # it had begun before the logging failed
        problem = without_places(error)
        init(*without)
    return problem


@contextlib.contextmanager
def start_errors(arguments: Sequence[str]) -> Iterator[None]:
    """Convert any exception of a block that starts ROS with arguments to RosStartError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')     # rclpy warns that it could not clean up
            yield
    except RosStartError:
        raise
    except Exception as error:
        from bahrs_driver.settings.start_errors import explain
        raise RosStartError(explain(error, arguments)) from error


def missing_module(error: ImportError) -> str:
    """Return a sentence about a module that cannot be imported, with the remedy."""
    what = f'the Python module {error.name} is missing' \
        if isinstance(error, ModuleNotFoundError) else printable(error, _LONGEST_REASON)
    return f'{what}; install it, or source the set-up of your ROS 2'


def _quoted(text: object) -> str:
    return f"'{printable(text)}'"
