# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test that the last value of a parameter on the command line is used, unlike in rcl."""

from bahrs_driver.settings.command_line import RosArguments
from hypothesis import given, strategies as st
import pytest
from support.node_settings import node_settings
import yaml


@pytest.mark.parametrize('words, files, rules', [
    ([], [], []),
    (['x', '-p', 'a:=1'], [], []),
    (['--ros-args', '-p', 'a:=1', '--param', 'b:=2'], [], ['a:=1', 'b:=2']),
    (['--ros-args', '-p', 'a:=1', '-p', 'b:=2', '-p', 'a:=3'], [], ['b:=2', 'a:=3']),
    (['--ros-args', '-p', 'a:=1', '--params-file', 'f', '-p', 'b:=2'], ['f'], ['b:=2']),
    (['--ros-args', '--params-file', 'f', '--', '-p', 'a:=1', '--ros-args', '-p', 'b:=2'],
     ['f'], ['b:=2']),
    (['--ros-args', '-r', '-p', 'a:=1', '--params-file'], [], []),
])
def test_files_and_rules_are_found(words, files, rules):
    """Arguments between --ros-args and --; only the last rule of each name."""
    arguments = RosArguments.from_words(words)
    assert arguments.files == files and list(arguments.last_rules.values()) == rules


def written(folder, number, key, name, value):
    """Write a parameter file and return its path."""
    path = folder / f'{number}.yaml'
    path.write_text(yaml.safe_dump({key: {'ros__parameters': {name: value}}}))
    return str(path)


KEYS = st.sampled_from(['/**', '/*', 'bahrs_driver', '/bahrs_driver', '/**/bahrs_driver'])


@pytest.mark.slow
@given(files=st.lists(st.tuples(KEYS, st.sampled_from([1, 2.5, True, 'text', [1, 2]])),
                      max_size=3),
       rules=st.lists(st.sampled_from([1, 2, 2.5]), min_size=1, max_size=3))
def test_the_last_rule_beats_every_file_before_it(tmp_path_factory, files, rules):
    """It overrides files for any node, and values of any type."""
    folder = tmp_path_factory.mktemp('files')
    words = ['driver_node', '--ros-args']
    for number, (key, value) in enumerate(files):
        words += ['--params-file', written(folder, number, key, 'stddev.velocity', value)]
    for value in rules:
        words += ['-p', f'stddev.velocity:={value}']
    assert node_settings(words)[1].stddev.velocity == rules[-1]


def test_a_file_after_a_rule_beats_it(tmp_path):
    """A launch file passes global parameters first, then those of the node."""
    file = written(tmp_path, 0, '/**', 'stddev.velocity', 3.0)
    words = ['driver_node', '--ros-args', '-p', 'stddev.velocity:=2.0', '--params-file', file]
    assert node_settings(words)[1].stddev.velocity == 3.0


def test_a_default_is_used_where_nothing_is_given():
    """A file for another node changes nothing."""
    assert node_settings(['driver_node'])[1].stddev.velocity == 0.2
