# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Explain in one sentence why ROS or the node cannot start."""

from collections.abc import Iterator, Sequence
import contextlib
import re
import warnings

from bahrs_driver.errors import ParameterError, RosStartError
from bahrs_driver.process.printable import printable
from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.parameter_files import file_problem
from rclpy.exceptions import ParameterException

# Every sentence of rcl ends with lines of its source; one about an argument quotes it.
_SOURCE_LINES = re.compile(r'\s*, at /\S+:\d+(?=, at |$)')
_ARGUMENT = re.compile(r"Couldn't parse (?P<what>[^:]+): '(?P<argument>.*)'\. Error: (?P<why>.*)",
                       re.DOTALL)
# Messages of ROS about its environment, and the remedy.
_ENVIRONMENT = (
    ('Unable to resolve peer', 'correct or unset ROS_STATIC_PEERS'),
    ('error not set', 'with security enforced, correct the ROS_SECURITY_ variables'),
)
_REMEDIES = {
    'params file': 'write a node name or /**, below it ros__parameters, and below that '
                   'NAME: VALUE',
    'parameter override rule': 'write -p NAME:=VALUE, with a value of YAML',
    'remap rule': 'write -r FROM:=TO',
    'log level': 'write --log-level debug, info, warn, error or fatal',
}

# Remappings of the name of a node and of its namespace, about which rcl only reports lexemes.
_NODE_NAME = 'a node name has letters, digits and underscores, and no digit first'
_NAMES = {
    '__node': _NODE_NAME,
    '__name': _NODE_NAME,
    '__ns': 'a namespace begins with a slash, such as /left, and has letters, digits and '
            'underscores',
}


@contextlib.contextmanager
def start_errors(words: Sequence[str]) -> Iterator[None]:
    """Raise RosStartError for any exception of a block that starts ROS with some arguments."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')     # rclpy warns of clean-up that failed
            yield
    except RosStartError:
        raise
    except Exception as error:
        raise RosStartError(explain(error, words)) from error


def explain(error: Exception, words: Sequence[str]) -> str:
    """Return why the node did not start with the words of a command line, and a remedy."""
    if isinstance(error, ParameterError):
        return str(error)
    for word in words:
        if not _is_utf8(word):
            return f'the argument {printable(word)} is not valid UTF-8: write it in UTF-8'
    if type(error).__name__ == 'UnknownROSArgsError':      # rclpy does not export it
        return (f"{printable(str(error).strip('[]'))} is not understood after --ros-args: put "
                'quotes around a value that holds a blank')
    if isinstance(error, ParameterException):
        # Raised for the parameters of rclpy, which are declared before any of this package.
        name = re.search(r"parameter '(\w+)'", str(error))
        return f'parameter {name[1]} must be true or false' if name else printable(error)
    for file in RosArguments.from_words(words).files:
        reason = file_problem(file)
        if reason:
            return reason
    return _plain(error)


def _plain(error: Exception) -> str:
    """Return the message of rcl or another library, with a remedy."""
    text = without_source_lines(error)
    about = _ARGUMENT.search(text)
    if about is None:
        shown = printable(text.rpartition('ROS arguments: ')[2] or type(error).__name__)
        remedies = (remedy for cause, remedy in _ENVIRONMENT if cause in text)
        return '; '.join([shown, *remedies])
    argument = printable(about['argument'])
    for target, rule in _NAMES.items():
        if about['what'] == 'remap rule' and f'{target}:=' in argument:
            return f'{argument} cannot be used: {rule}'
    remedy = _REMEDIES.get(about['what'], 'see "ros2 run --help"')
    why = '' if 'lexeme' in about['why'] else f": {printable(about['why'])}"
    return f'{argument} cannot be used{why}: {remedy}'


def without_source_lines(error: Exception) -> str:
    """Return a message of rcl on one line, without the lines of its source."""
    return ' '.join(_SOURCE_LINES.sub('', str(error)).split())


def _is_utf8(word: str) -> bool:
    try:
        word.encode()
    except UnicodeEncodeError:
        return False
    return True
