# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test that the driver starts with any arguments, or explains in one sentence why not."""

import os

from bahrs_driver.devices.registry import parameter_table
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from support.settings_examples import values_of
from support.starting import start
import yaml


def in_order(result):
    """Return whether a start went well, or ended with one sentence and no traceback."""
    assert 'Traceback' not in result.text and '.py' not in result.text, result.text
    if result.status:
        sentences = [line for line in result.lines if line.startswith('bahrs_driver: ')]
        assert result.status == 1 and len(sentences) == 1, result
        assert ', at /' not in sentences[0] and len(sentences[0]) < 700
    return True


@pytest.mark.parametrize('words, sentence', [
    (['-p', 'baud_rate:=[]'], 'parameter baud_rate is []: it must be a whole number'),
    (['-p', 'frame_id:=my frame'], "parameter frame_id is 'my frame': it must be the name of a"),
    (['-p', 'stddev.velocity:=-1'], 'parameter stddev.velocity is -1: it must be a decimal'),
    (['-p', 'stddev.velocity:=.nan'], 'parameter stddev.velocity is nan: it must be a decimal'),
    (['-p', 'use_sim_time:=[]'], 'parameter use_sim_time must be true or false'),
    (['-p', 'use_sim_time:=5'], 'parameter use_sim_time must be true or false'),
    (['-p', 'start_type_description_service:=x'],
     'parameter start_type_description_service must be true or false'),
    (['-p', 'qos_overrides./imu/data.publisher.depth:=-5'],
     'parameter qos_overrides./imu/data.publisher.depth is -5: it must be a whole number'),
    (['-p', 'qos_overrides./imu/data.publisher.history:=[]'],
     "parameter qos_overrides./imu/data.publisher.history is []: it must be 'keep_last' or"),
    (['-p', 'qos_overrides./imu/data.publisher.reliability:=unknown'],
     "parameter qos_overrides./imu/data.publisher.reliability is 'unknown': it must be 'reli"),
    (['-p', 'port'], '-p port cannot be used: '),
    (['-p', 'port:=[a, 1]'], '-p port:=[a, 1] cannot be used: Sequence should be of same type.'),
    (['-r', '__ns:=left'], '-r __ns:=left cannot be used: a namespace begins with a slash'),
    (['-r', '__node:=1st'], '-r __node:=1st cannot be used: a node name has letters, digits and'),
    (['-r', 'imu/data:=a b'], '-r imu/data:=a b cannot be used: write -r FROM:=TO'),
    (['-r', 'imu/data:=a', 'b'], "'b' is not understood after --ros-args: put quotes around"),
    (['--log-level', 'loud'], '--log-level loud cannot be used: Argument does not use a valid'),
    (['--params-file'], "Couldn't parse trailing --params-file flag. No file path provided."),
    (['--params-file', '/no/such.yaml'], 'parameter file /no/such.yaml cannot be read: No such'),
    (['-p', 'port:=\udcff'], r'the argument port:=\xff is not valid UTF-8'),
])
def test_sentences(monkeypatch, capfd, words, sentence):
    """They name the argument, and what to do."""
    result = start(monkeypatch, capfd, *words)
    assert result.status == 1 and in_order(result)
    assert f'bahrs_driver: {sentence}' in result.text


@pytest.mark.parametrize('content, sentence', [
    ('bahrs_driver:\n  port: x\n', 'Cannot have a value before ros__parameters at line 2'),
    ('ros__parameters:\n  port: x\n', 'There are no node names before ros__parameters at line 1'),
    ('/**:\n  ros__parameters:\n    port:\n', 'No value at line 3'),
    ('/**:\n  ros__parameters:\n    port: *x\n', 'correct line 3'),
    ('my node:\n  ros__parameters:\n    port: x\n', 'node name must not contain characters'),
    ('/**:\n  ros__parameters:\n    frame_id: {}\n', 'parameter frame_id is []: it must be'),
    ('/**:\n  ros__parameters:\n    sensor: "\\e[2J"\n', r"parameter sensor is '\x1b[2J': it"),
])
def test_sentences_about_files(monkeypatch, capfd, tmp_path, content, sentence):
    """They name the file, the line, and what to write."""
    file = tmp_path / 'my.yaml'
    file.write_text(content)
    result = start(monkeypatch, capfd, '--params-file', str(file))
    assert result.status == 1 and in_order(result) and sentence in result.text


ODD = st.one_of(
    st.none(), st.booleans(), st.integers(-2 ** 70, 2 ** 70), st.floats(width=64),
    st.text(max_size=20), st.lists(st.booleans(), max_size=2), st.lists(st.integers(), max_size=2),
    st.lists(st.floats(), max_size=2), st.lists(st.text(max_size=3), max_size=2),
    st.dictionaries(st.text(max_size=3), st.integers(), max_size=2), st.binary(max_size=4),
    st.sampled_from(['', ' ', '~', '*a', '&a', '!!int x', '!!binary x', '[[]]', '{', '1e999',
                     '0x10', '1_000', '.inf', '-.inf', 'on', 'no', '"', '- 1', '? a', '\t', '#']))
NAMES = st.one_of(
    st.sampled_from([*(parameter.name for parameter in parameter_table()), 'use_sim_time',
                     'start_type_description_service', '/**', 'unknown.name',
                     *(f'qos_overrides./imu/data.publisher.{policy}'
                       for policy in ('depth', 'history', 'reliability', 'durability', 'x'))]),
    st.text(max_size=10))


def written_as(value):
    """Return a value as YAML on one line."""
    if isinstance(value, str):
        return value
    return yaml.safe_dump(value, default_flow_style=True).partition('\n')[0]


@settings(max_examples=120, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rules=st.lists(st.tuples(NAMES, ODD), min_size=1, max_size=3))
def test_any_rule(monkeypatch, capfd, rules):
    """Of any name and value. An argument cannot hold a null character."""
    words = [f'{name}:={written_as(value)}'.replace('\0', '') for name, value in rules]
    assert in_order(start(monkeypatch, capfd,
                          *(word for rule in words for word in ('-p', rule))))


FILE = ('/**:\n  ros__parameters:\n    frame_id: imu\n    stddev:\n      velocity: 0.2\n'
        '    list: [1, 2]\n')
PIECES = st.sampled_from([
    '/**', 'bahrs_driver', 'ros__parameters', ':', ': ', '\n', '\n  ', '\n    ', '- ', '[', ']',
    '{', '}', ', ', '5', 'true', '~', '"', "'", '&a', '*a', '!!binary', '|', '#', '---\n', '\t',
    '\x00', '\x1b[2J', '\udc80', 'é', '%', '<<: *a', '/', '{}', '[]'])
EDITS = st.lists(st.tuples(st.integers(0, len(FILE)), st.integers(0, 6), PIECES), max_size=4)


@settings(max_examples=120, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(edits=EDITS)
def test_any_file(monkeypatch, capfd, tmp_path, edits):
    """One that is right but for some edits, which is where parsers go wrong."""
    content = FILE
    for place, removed, piece in edits:
        content = content[:place] + piece + content[place + removed:]
    file = tmp_path / 'my.yaml'
    file.write_bytes(content.encode(errors='surrogateescape'))
    assert in_order(start(monkeypatch, capfd, '--params-file', str(file)))


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(words=st.lists(st.one_of(st.sampled_from(
    ['-p', '--param', '-r', '--remap', '--params-file', '--log-level', '-e', '--', '--ros-args',
     '__node:=x', '__ns:=/x', 'a:=b', '--log-config-file', '--disable-stdout-logs']),
    st.text(max_size=5)), max_size=4))
def test_any_words(monkeypatch, capfd, words):
    """Which are no arguments of ROS, or half of one."""
    assert in_order(start(monkeypatch, capfd, *(word.replace('\0', '') for word in words)))


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(values=st.fixed_dictionaries({parameter.name: values_of(parameter)
                                     for parameter in parameter_table()
                                     if parameter.name != 'port'}))
def test_any_valid_values(monkeypatch, capfd, tmp_path, values):
    """The driver starts with them, however they are combined."""
    file = tmp_path / 'my.yaml'
    file.write_text(yaml.safe_dump({'/**': {'ros__parameters': values}}))
    result = start(monkeypatch, capfd, '--params-file', str(file))
    assert result.status == 0 and in_order(result)


def test_a_file_without_permission(monkeypatch, capfd, tmp_path):
    """The reason is that of the system."""
    if os.geteuid() == 0:
        pytest.skip('root may read every file')
    file = tmp_path / 'my.yaml'
    file.write_text(FILE)
    file.chmod(0)
    result = start(monkeypatch, capfd, '--params-file', str(file))
    assert result.status == 1 and 'cannot be read: Permission denied' in result.text
