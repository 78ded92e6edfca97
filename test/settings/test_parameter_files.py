# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Parameter files: explanations of problems, and the nodes that a file has parameters for."""

import os
import threading

from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.parameter_files import file_problem, LARGEST, other_nodes
from bahrs_driver.settings.parameter_node import ParameterNode
from hypothesis import given, strategies as st
import pytest
from rclpy.context import Context
import yaml


def applies(path, name, namespace):
    """Return whether rclpy passes parameters of a file to a node."""
    context = Context()
    context.init(['node', '--ros-args', '-r', f'__node:={name}', '-r', f'__ns:={namespace}',
                  '--params-file', str(path)])
    node = ParameterNode(RosArguments(), context)
    try:
        return bool(node.given)
    finally:
        node.destroy_node()
        context.try_shutdown()


PARTS = st.sampled_from(['*', '**', 'bahrs_driver', 'front', 'left', 'uav_1'])
PATTERNS = st.builds(lambda slash, parts: slash + '/'.join(parts),
                     st.sampled_from(['', '/']), st.lists(PARTS, min_size=1, max_size=3))


@given(patterns=st.lists(PATTERNS, min_size=1, max_size=2), nested=st.booleans(),
       name=st.sampled_from(['bahrs_driver', 'front']),
       namespace=st.sampled_from(['/', '/left', '/uav_1/left']))
def test_it_matches_as_rclpy_does(tmp_path_factory, patterns, nested, name, namespace):
    """With wildcards and nested keys."""
    tree = {}
    for pattern in patterns:
        values = {'ros__parameters': {'port': 'x'}}
        head, _, tail = pattern.rpartition('/')
        tree[head if nested and head else pattern] = {tail: values} if nested and head else values
    path = tmp_path_factory.mktemp('files') / 'file.yaml'
    path.write_text(yaml.safe_dump(tree))
    full_name = f"{namespace.rstrip('/')}/{name}"
    try:
        expected = applies(path, name, namespace)
    except RuntimeError:
        return                          # such as **/**, which rcl does not allow
    assert (other_nodes(str(path), full_name) is None) == expected


def test_the_names_in_a_file_are_returned(tmp_path):
    """Each once, in the form of rcl."""
    path = tmp_path / 'file.yaml'
    path.write_text('left:\n  bahrs_driver:\n    ros__parameters: {port: x}\n'
                    '/right/*:\n  ros__parameters: {port: y}\n'
                    '---\nother:\n  ros__parameters: {port: y}\n')
    assert other_nodes(str(path), '/bahrs_driver') == ['left/bahrs_driver', '/right/*', 'other']
    assert other_nodes(str(path), '/left/bahrs_driver') is None
    path.write_text('')
    assert other_nodes(str(path), '/bahrs_driver') == []


@pytest.mark.parametrize('content, sentence', [
    (b'a: [b\nc', 'is not valid YAML: correct line 2: expected'),
    (b'a:\n\tb: c', 'is not valid YAML: correct line 2: found character'),
    (b'\xff\xfe\x00\x01', 'is not a YAML file: check the path'),
    (b'a: \x1b[2J', 'is not a YAML file: check the path'),
    (b'[' * 2000, 'is not a YAML file: check the path'),
    (b'# comment\n' * (LARGEST // 10 + 1), 'is not a YAML file: check the path'),
])
def test_a_file_that_is_no_yaml(tmp_path, content, sentence):
    """One sentence names the line, or says that it is the wrong file; no exception."""
    path = tmp_path / 'file.yaml'
    path.write_bytes(content)
    assert sentence in file_problem(str(path))
    assert other_nodes(str(path), '/bahrs_driver') is None


def test_a_file_that_cannot_be_read(tmp_path):
    """The sentence has the reason of the system."""
    assert 'cannot be read: No such file or directory' in file_problem(str(tmp_path / 'none'))
    assert 'cannot be read: Is a directory' in file_problem(str(tmp_path))
    assert other_nodes(str(tmp_path / 'none'), '/bahrs_driver') is None


def test_a_pipe_is_left_to_rcl(tmp_path):
    """Its content can be read only once, and reading waits for a writer."""
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    results = []
    thread = threading.Thread(target=lambda: results.extend(
        [file_problem(str(path)), other_nodes(str(path), '/bahrs_driver')]), daemon=True)
    thread.start()
    thread.join(60)
    assert results == [None, None]
