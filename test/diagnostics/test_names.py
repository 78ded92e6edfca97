# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the names of statuses."""

from bahrs_driver.diagnostics.names import node_label, parse_status_name, status_name
from bahrs_driver.ros.node_names import full_name, split_name
from hypothesis import given, strategies as st
import pytest

NAMES = st.from_regex(r'[a-z][a-z0-9_]{0,8}', fullmatch=True)
NAMESPACES = st.lists(NAMES, max_size=3).map(lambda parts: '/' + '/'.join(parts))


@pytest.mark.parametrize('node, label', [
    (('bahrs_driver', '/'), 'bahrs_driver'),
    (('front', ''), 'front'),
    (('bahrs_driver', '/left'), '/left/bahrs_driver'),
    (('bahrs_driver', '/', True), '/bahrs_driver'),
    (('bahrs_driver', '/left', True), '/left/bahrs_driver'),
])
def test_node_label(node, label):
    """It is the bare name in the root namespace, otherwise or on request the full name."""
    assert node_label(*node) == label


@pytest.mark.parametrize('text, node, task', [
    ('bahrs_driver: Link', '/bahrs_driver', 'Link'),
    ('/left/front: Time', '/left/front', 'Time'),
    ('Link', '', 'Link'),
    ('gps: fix: age', '/gps', 'fix: age'),
    ('', '', ''),
])
def test_parse_status_name(text, node, task):
    """Names of other drivers are parsed, too."""
    assert parse_status_name(text) == (node, task)


@given(NAMES, NAMESPACES, st.booleans())
def test_a_status_name_identifies_the_node(name, namespace, qualified):
    """Parsing the status name returns the full name of any node."""
    full = full_name(name, namespace)
    status = status_name(node_label(name, namespace, qualified), 'Link')
    assert parse_status_name(status) == (full, 'Link')
    assert split_name(full) == (name, namespace)
