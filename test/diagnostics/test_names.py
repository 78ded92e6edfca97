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
def test_label(node, label):
    """The bare name at the root, the full one in a namespace or if wanted."""
    assert node_label(*node) == label


@pytest.mark.parametrize('text, node, task', [
    ('bahrs_driver: Link', '/bahrs_driver', 'Link'),
    ('/left/front: Time', '/left/front', 'Time'),
    ('Link', '', 'Link'),
    ('gps: fix: age', '/gps', 'fix: age'),
    ('', '', ''),
])
def test_parsed(text, node, task):
    """Also names that this driver did not make."""
    assert parse_status_name(text) == (node, task)


@given(NAMES, NAMESPACES, st.booleans())
def test_a_status_tells_its_node(name, namespace, qualified):
    """Whatever the node is called; and no two nodes share a name."""
    full = full_name(name, namespace)
    status = status_name(node_label(name, namespace, qualified), 'Link')
    assert parse_status_name(status) == (full, 'Link')
    assert split_name(full) == (name, namespace)
