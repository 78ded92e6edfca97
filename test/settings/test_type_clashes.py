# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Values that rcl does not use because of the type of an earlier one are reported."""

from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.parameter_node import ParameterNode
from bahrs_driver.settings.type_clashes import ignored_values
from hypothesis import given, settings, strategies as st
from rclpy.context import Context
from support.starting import start

# As YAML, and as rcl reads it.
VALUES = {'1': 1, '2.5': 2.5, '1e-5': 1e-5, '0x10': 16, 'true': True, 'off': False, 'text': 'text',
          '"1"': '1', "'true'": 'true', '.inf': float('inf'), '-7': -7, '+.5': 0.5,
          '1_000': '1_000'}
KEYS = ('/**', '/bahrs_driver', 'other')


def used(words):
    """Return the value that rcl uses for a parameter of the node, or None."""
    context = Context()
    context.init(['node', *words])
    node = ParameterNode(RosArguments(), context)
    try:
        return node.given.get('velocity')
    finally:
        node.destroy_node()
        context.try_shutdown()


def ignored(words):
    """Return the sentences about a command line."""
    return list(ignored_values(RosArguments.from_words(words), '/bahrs_driver'))


SOURCES = st.lists(st.tuples(st.sampled_from(['rule', *KEYS]), st.sampled_from(sorted(VALUES))),
                   min_size=1, max_size=4)


@settings(max_examples=150)
@given(sources=SOURCES)
def test_what_rcl_does_not_use_is_reported(tmp_path_factory, sources):
    """Exactly if the last value of a parameter is not the one that rcl uses."""
    folder, words = tmp_path_factory.mktemp('files'), ['--ros-args']
    for number, (key, text) in enumerate(sources):
        file = folder / f'{number}.yaml'
        file.write_text(f'{key}:\n  ros__parameters:\n    velocity: {text}\n')
        words += ['-p', f'velocity:={text}'] if key == 'rule' else ['--params-file', str(file)]
    names = ['/**' if key == 'rule' else key for key, _ in sources]
    if len(set(names) - {'other'}) != 1:
        return                          # what rcl uses of each cannot be seen
    last = next(text for (_, text), name in reversed([*zip(sources, names)]) if name != 'other')
    value = used(words)
    rules_last = sources[-1][0] == 'rule'
    expected = not rules_last and (value, type(value)) != (VALUES[last], type(VALUES[last]))
    assert bool(ignored(words)) == expected


def test_it_is_among_the_settings_without_effect(monkeypatch, capfd, tmp_path):
    """With the remedy. A rule after the files is always used."""
    first, second = tmp_path / 'a.yaml', tmp_path / 'b.yaml'
    first.write_text('/**:\n  ros__parameters:\n    stddev:\n      velocity: 1\n')
    second.write_text('/**:\n  ros__parameters:\n    stddev.velocity: 0.5\n')
    words = ['--params-file', str(first), '--params-file', str(second)]
    status, lines = start(monkeypatch, capfd, *words)
    assert status == 0 and len(lines) == 1
    assert ('settings without effect: stddev.velocity: 0.5 (rcl uses an earlier value of another '
            'type: write both in the same form)') in lines[0]
    assert start(monkeypatch, capfd, *words, '-p', 'stddev.velocity:=0.5') == (0, [])
