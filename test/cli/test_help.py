# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of help and exit status of all verbs."""

import re
import shlex
import subprocess

from bahrs_driver.cli.main import _parser, main, VERBS
import pytest
from support.processes import command

NO_EXAMPLES_FOR = re.compile(r'\s{2,}')         # what an example is for stands behind it


def help_text(capsys, *words):
    """Return the output of --help."""
    with pytest.raises(SystemExit) as ended:
        main([*words, '--help'])
    assert ended.value.code == 0
    return capsys.readouterr().out


def examples(text):
    """Return the example commands in a help text, without their comments."""
    lines = re.findall(r'^(?:  |example: )(bahrs .*)$', text, re.MULTILINE)
    return [NO_EXAMPLES_FOR.split(line)[0] for line in lines]


@pytest.mark.parametrize('verb', VERBS)
def test_help_has_examples_that_work(verb, capsys):
    """The command line accepts each example, and the exit status is explained."""
    text = help_text(capsys, verb)
    found = [line for line in examples(text) if line.startswith(f'bahrs {verb} ')
             or line == f'bahrs {verb}']
    assert found and 'exit status: ' in text and '\x1b' not in text
    for line in found:
        words = shlex.split(line.split(' > ')[0].split(' | ')[0])[1:]
        assert _parser(verb).parse_args(words).verb == verb


@pytest.mark.parametrize('action', ['read', 'dump', 'show'])
def test_help_of_nvm_actions(action, capsys):
    """Each action has an example."""
    (line,) = examples(help_text(capsys, 'nvm', action))
    assert _parser('nvm').parse_args(shlex.split(line)[1:]).action == action


def test_general_help(capsys):
    """It lists all verbs."""
    text = help_text(capsys)
    assert all(re.search(rf'^    {verb} +\w', text, re.MULTILINE) for verb in VERBS)
    assert '130 at Ctrl-C' in text


@pytest.mark.parametrize('words', [[], ['nothing'], ['decode'], ['decode', '--nothing', 'file'],
                                   ['monitor', '--duration', 'long']])
def test_command_line_errors(words, capsys):
    """The exit status is 2, and one line has the reason."""
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert 'error: ' in capsys.readouterr().err


def test_version():
    """The option --version works."""
    done = subprocess.run(command('bahrs', '--version'), capture_output=True, text=True,
                          timeout=60, check=True)
    assert re.fullmatch(r'bahrs \d+\.\d+\.\d+\n', done.stdout)
