# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the monitor with messages of other nodes: no exception, no control sequence."""

import io
import json
import re

from bahrs_driver.devices.registry import all_topics
from bahrs_driver.monitor.page import Page
from bahrs_driver.monitor.tables import tables, to_json
from bahrs_driver.monitor.watch import DIAGNOSTICS, Watch
from bahrs_driver.ros.node_names import Selection
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Quaternion
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
import rclpy
from rclpy.context import Context
from rclpy.serialization import serialize_message
from rich.console import Console
from support.ros_messages import message_types

TOPICS = message_types(all_topics())
NODE = '/bahrs_driver'
FLOATS = st.one_of(st.floats(), st.sampled_from([float('nan'), float('inf'), 1e308, -1e154, 0.0]))
TEXTS = st.one_of(
    st.sampled_from(['\x1bc', '\x1b[2J', '\x9b2J', '\r', '\n', '[bold]', '[/]', '[/bold]',
                     '\u202e', 'bahrs_driver: Link', '/bahrs_driver: ', 'a' * 2000,
                     'bahrs_driver: [red]x[/red]']),
    st.text(st.characters(blacklist_characters='\0', blacklist_categories=['Cs']), max_size=9))
STATUSES = st.builds(
    DiagnosticStatus, level=st.binary(min_size=1, max_size=1), message=TEXTS, hardware_id=TEXTS,
    name=st.one_of(TEXTS, TEXTS.map('bahrs_driver: {}'.format), TEXTS.map(f'{NODE}: {{}}'.format)),
    values=st.lists(st.builds(KeyValue, key=TEXTS, value=TEXTS), max_size=3))
TURNS = st.sampled_from([(1.0, 0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 0.5), (0.7, 0.0, 0.72, 0.0)])
BITS = (8, 16, 32)
INTEGERS = {**{f'int{bits}': (-2 ** (bits - 1), 2 ** (bits - 1) - 1) for bits in BITS},
            **{f'uint{bits}': (0, 2 ** bits - 1) for bits in BITS}}


def values(slot):
    """Return a strategy for a field of a rosidl type."""
    if slot in INTEGERS:
        return st.integers(*INTEGERS[slot])
    if slot == 'double':
        return FLOATS
    if slot == 'string':
        return TEXTS
    array = re.fullmatch(r'double\[(\d+)\]', slot)
    if array:
        size = int(array[1])
        return st.one_of(st.lists(FLOATS, min_size=size, max_size=size),
                         st.just([float('inf')] * size))
    if slot == 'sequence<diagnostic_msgs/DiagnosticStatus>':
        return st.lists(STATUSES, max_size=80)
    package, name = slot.split('/')
    kind = messages(getattr(__import__(f'{package}.msg', fromlist=[name]), name))
    if name == 'Quaternion':
        return st.one_of(kind, TURNS.map(lambda q: Quaternion(w=q[0], x=q[1], y=q[2], z=q[3])))
    return kind


def messages(kind):
    """Return a strategy for messages of a type with arbitrary values."""
    return st.builds(kind, **{
        name: values(slot) for name, slot in kind.get_fields_and_field_types().items()})


@pytest.fixture(scope='module')
def node():
    """Return a node in a context of its own."""
    context = Context()
    rclpy.init(context=context)
    node = rclpy.create_node('fuzzed', context=context)
    yield node
    rclpy.shutdown(context=context)


@pytest.fixture
def watch(node):
    """Return a watch that receives only the messages of the test."""
    made = Watch(node, Selection('bahrs_driver', '/'))
    yield made
    for subscription in list(node.subscriptions):
        node.destroy_subscription(subscription)


def rendered(renderable, size):
    """Return the output on a terminal."""
    out = io.StringIO()
    width, height = size
    Console(file=out, width=width, height=height, force_terminal=True).print(renderable)
    return out.getvalue()


def is_harmless(text):
    """Return whether the only control characters are line ends and the colours of rich."""
    return re.sub(r'\x1b\[[0-9;]*m|\n', '', text).isprintable()


def show_everywhere(watch):
    """Draw the page, the tables and the JSON object."""
    watch.spin(0.0)
    for size in ((60, 16), (200, 60)):
        assert is_harmless(rendered(Page(watch), size))
    assert is_harmless(rendered(tables(watch), (80, 24)))
    assert json.loads(json.dumps(to_json(watch), allow_nan=False))['heard']


@pytest.mark.parametrize('topic', TOPICS)
@settings(max_examples=25, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_any_message_of_a_topic(watch, topic, data):
    """Numbers, texts and lists are arbitrary."""
    watch._count(topic, serialize_message(data.draw(messages(TOPICS[topic]))))
    show_everywhere(watch)


@settings(max_examples=40, suppress_health_check=list(HealthCheck))
@given(arrays=st.lists(messages(DiagnosticArray), min_size=1, max_size=3))
def test_any_diagnostics(watch, arrays):
    """Statuses are of this driver and of other nodes."""
    watch._count('heading', serialize_message(TOPICS['heading']()))
    for array in arrays:
        watch._update_health(serialize_message(array))
    show_everywhere(watch)
    assert len(watch.health.tasks) <= 16


@pytest.mark.parametrize('topic', [*TOPICS, DIAGNOSTICS])
@settings(max_examples=20, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=400))
def test_malformed_messages(watch, topic, data):
    """The type of another publisher may only have the same name."""
    watch._count('heading', serialize_message(TOPICS['heading']()))
    if topic == DIAGNOSTICS:
        watch._update_health(data)
    else:
        watch._count(topic, data)
    show_everywhere(watch)


def test_enormous_list(watch):
    """It is truncated."""
    array = DiagnosticArray(status=[
        DiagnosticStatus(name=f'bahrs_driver: {index}', message='x' * 1000)
        for index in range(5000)])
    watch._update_health(serialize_message(array))
    watch._count('integrity', serialize_message(array))
    show_everywhere(watch)
    assert len(json.dumps(to_json(watch))) < 100_000


@pytest.mark.parametrize('text, as_shown', [
    ('\x1bc 2.7', r'\x1bc 2.7'), ('[bold]x[/]', '[bold]x[/]'), ('[/nothing]', '[/nothing]')])
def test_markup_and_control_characters(watch, text, as_shown):
    """They are shown as text."""
    watch._update_health(serialize_message(DiagnosticArray(status=[
        DiagnosticStatus(name=f'bahrs_driver: {text}', message=text)])))
    assert rendered(tables(watch), (80, 24)).count(as_shown) == 2
    watch._count('heading', serialize_message(TOPICS['heading']()))
    assert as_shown in rendered(Page(watch), (80, 24))
