# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `bahrs`: run a verb, and report errors in one sentence."""

import argparse
from importlib import import_module
from io import TextIOWrapper
import os
import sys
from typing import NoReturn

from bahrs_driver import __version__
from bahrs_driver.cli.printing import warn
from bahrs_driver.cli.signals import interrupt_on_signals, signals_deferred
from bahrs_driver.errors import BahrsDriverError, CommandError
from bahrs_driver.process.exit_timer import exit_after
from bahrs_driver.process.printable import printable
from bahrs_driver.process.shutdown_event import ignore_signals
from bahrs_driver.process.standard_streams import replace_closed_streams
from bahrs_driver.ros.start import check_import, missing_module
from bahrs_driver.settings.command_line import split_arguments

# Each verb is the module of its name. Only the chosen module is imported: verbs that need no ROS
# work without it.
VERBS = {
    'convert': 'regenerate all topics from raw bytes',
    'decode': 'decode the messages in a stream of bytes',
    'doctor': 'diagnose missing data and print the fix',
    'emulate': 'simulate a device on a pseudo-terminal or into a file',
    'monitor': 'show the topics of the driver live',
    'nvm': 'read the non-volatile memory of a device',
    'record': 'record the topics of the driver into a bag',
    'replay': 'play a recorded stream of bytes on a pseudo-terminal',
    'report': 'write an HTML page about a recording',
}

IMPORT_RCLPY = ('monitor', 'record')
ROS_NODES = ('doctor', 'monitor', 'record')     # verbs that pass --ros-args to ROS
MAX_ERROR_LENGTH = 2000     # characters; names of files may be long
CLEAN_UP_TIME = 1.0         # s for the nodes of verbs at the end of the process

_EXIT_STATUS = ('0 on success, 1 if the verb fails or finds a problem, 2 for a wrong command\n'
                'line, 130 at Ctrl-C')
_EPILOG = f"""examples:
  bahrs doctor                      diagnose missing data
  bahrs monitor                     show the topics of the driver live
  bahrs decode --help               show the options and examples of a verb

exit status: {_EXIT_STATUS}
"""


class _Parser(argparse.ArgumentParser):
    """Reports errors of the command line in printable characters."""

    def error(self, message: str) -> NoReturn:
        """Print the usage and the error, and exit with status 2."""
        super().error(printable(message, MAX_ERROR_LENGTH))


def main(args: list[str] | None = None) -> int:
    """Run one verb; 0 on success, 1 on failure, 2 for a wrong command line."""
    if args is None:
        replace_closed_streams()
    words, for_ros = split_arguments(sys.argv[1:] if args is None else args)
    if isinstance(sys.stdout, TextIOWrapper):       # names of files may be any bytes
        sys.stdout.reconfigure(errors='backslashreplace')
    verb = words[0] if words else ''
    status = _status(verb, words, for_ros)
    if args is None:
        ignore_signals()
        if verb in ROS_NODES:           # destroys their nodes
            exit_after(CLEAN_UP_TIME, status)
    return status


def _status(verb: str, words: list[str], for_ros: list[str]) -> int:
    """Run one verb and return the exit status."""
    try:
        interrupt_on_signals()
        return _run(verb, words, for_ros)
    except BahrsDriverError as error:
        warn(verb, printable(error, MAX_ERROR_LENGTH))
        return 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # The reader of the output has closed it: prevent an error at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        warn(verb, f'cannot continue: {printable(error.strerror or error)}')
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def _run(verb: str, words: list[str], for_ros: list[str]) -> int:
    options = _parser(verb).parse_args(words)
    options.ros_arguments = for_ros
    if len(for_ros) > 1 and verb not in ROS_NODES:
        warn(verb, f'{printable(" ".join(for_ros))} has no effect: this verb is not a ROS node')
    status: int = options.run(options)
    sys.stdout.flush()
    return status


def _parser(chosen: str) -> argparse.ArgumentParser:
    parser = _Parser(
        prog='bahrs', description='Tools for the sensors of bahrs_driver.', epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--version', action='version', version=f'bahrs {__version__}')
    subparsers = parser.add_subparsers(dest='verb', metavar='VERB', required=True)
    for verb, summary in VERBS.items():
        subparser = subparsers.add_parser(
            verb, help=summary, formatter_class=argparse.RawDescriptionHelpFormatter)
        if verb == chosen:
            module = _module(verb)
            module.add_arguments(subparser)
            exit_status = getattr(module, 'EXIT_STATUS', _EXIT_STATUS)
            subparser.epilog = f'{(subparser.epilog or "").rstrip()}\n\nexit status: {exit_status}'
            subparser.set_defaults(run=module.run)
    return parser


def _module(verb: str):  # type: ignore[no-untyped-def]
    if verb in IMPORT_RCLPY:
        check_import()
    try:
        with signals_deferred():
            return import_module(f'bahrs_driver.cli.{verb}')
    except ImportError as error:
        raise CommandError(missing_module(error)) from error
