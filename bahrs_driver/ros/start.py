# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start ROS, or say in one sentence why it cannot start.

Some values of the environment make ROS end the process, without an exception: an unknown
RMW_IMPLEMENTATION already when rclpy is imported. So they are checked here first, and this module
imports rclpy only when it is used.
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

HIGHEST_DOMAIN = 232            # above, its ports would be beyond 65535
SAFE_DOMAIN = 101               # above, its ports collide with those that Linux gives away
CHOOSER = 'rmw_implementation'  # is no middleware itself, but loads one
SWITCHES = ('RCUTILS_COLORIZED_OUTPUT', 'RCUTILS_LOGGING_USE_STDOUT',
            'RCUTILS_LOGGING_BUFFERED_STREAM')
NO_LOG_FILES = ('--ros-args', '--disable-external-lib-logs')
_MIDDLEWARES = 'share/ament_index/resource_index/rmw_typesupport'
_LONGEST_REASON = 300


def middlewares(environment: Mapping[str, str], python: Path = Path(sys.prefix)) -> list[str]:
    """Return the middlewares that are installed; none where that cannot be found out."""
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
    """Return whether a text is a domain up to a number; without text it is the default."""
    return not text or (text.isascii() and text.isdecimal() and len(text) < 10
                        and int(text) <= highest)


def log_directory(environment: Mapping[str, str] = os.environ) -> str:
    """Return where ROS writes its log files; with a ~ if there is no home directory."""
    text = environment.get('ROS_LOG_DIR') or \
        os.path.join(environment.get('ROS_HOME') or '~/.ros', 'log')
    home = environment.get('HOME', '')
    return home + text[1:] if home and text.startswith('~') else text


def log_problem(environment: Mapping[str, str] = os.environ) -> str:
    """Return why ROS cannot write log files; empty if it can. Nothing is left behind."""
    folder = log_directory(environment)
    if folder.startswith('~'):
        return f'{_quoted(folder)} needs HOME, which is not set'
    place = Path(os.path.abspath(folder))
    try:
        while not place.exists():
            place = place.parent
    except (OSError, ValueError) as error:
        return f'{_quoted(folder)} cannot be used: {printable(error)}'
    if not place.is_dir():
        return f'{_quoted(folder)} cannot be made: {_quoted(place)} is no directory'
    try:
        # Permissions are not enough: a file system may be full, or hold no files.
        with tempfile.TemporaryFile(dir=place):
            return ''
    except OSError as error:
        return f'{_quoted(place)} cannot be written: {printable(error.strerror)}'


def init_ros(arguments: Sequence[str], log_files: bool = True) -> str:
    """Initialise ROS without its signal handlers; return why it writes no log files, if so."""
    check_environment()
    import rclpy
    from rclpy._rclpy_pybind11 import RCLError
    from bahrs_driver.settings.start_errors import without_places
    from rclpy.signals import SignalHandlerOptions

    def init(*more: str) -> None:
        rclpy.init(args=[*arguments, *more], signal_handler_options=SignalHandlerOptions.NO)

    # A flag without its value would take what follows for it.
    without = () if arguments and arguments[-1].startswith('-') else NO_LOG_FILES
    problem = log_problem() if log_files else 'they are not wanted'
    try:
        init(*(without if problem else ()))
    except RCLError as error:
        if 'logging' not in str(error):
            raise
        rclpy.try_shutdown()        # what was begun before the logging failed
        problem = without_places(error)
        init(*without)
    return problem


@contextlib.contextmanager
def start_errors(arguments: Sequence[str]) -> Iterator[None]:
    """Raise RosStartError for any exception of a block that starts ROS with some arguments."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')     # rclpy warns of what it could not tidy up
            yield
    except RosStartError:
        raise
    except Exception as error:
        from bahrs_driver.settings.start_errors import explain
        raise RosStartError(explain(error, arguments)) from error


def missing_module(error: ImportError) -> str:
    """Return what to do about a module that cannot be imported, in a sentence."""
    what = f'the Python module {error.name} is missing' \
        if isinstance(error, ModuleNotFoundError) else printable(error, _LONGEST_REASON)
    return f'{what}; install it, or source the set-up of your ROS 2'


def _quoted(text: object) -> str:
    return f"'{printable(text)}'"
