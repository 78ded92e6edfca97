# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the layouts for Foxglove and PlotJuggler: they name what the node publishes."""

from collections.abc import Iterator
import json
from pathlib import Path
import re
from typing import Any
from xml.etree import ElementTree

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
import pytest
from support.ros_messages import message_types

CONFIG = Path(__file__).resolve().parents[2] / 'config'
ALL_TOPICS = {**message_types(TOPICS), 'diagnostics': DiagnosticArray}
# Of the topics here, the 3D panels of Foxglove and Lichtblick show only this type.
IN_3D = {PoseWithCovarianceStamped}


def foxglove() -> dict[str, Any]:
    """Return the layout for Foxglove."""
    return json.loads((CONFIG / 'foxglove_layout.json').read_text())


def panels(node: Any) -> Iterator[str]:
    """Yield the panels of a Foxglove layout, in tabs, too."""
    if isinstance(node, str):
        yield node
        for tab in foxglove()['configById'][node].get('tabs', []):
            yield from panels(tab['layout'])
    else:
        assert node['direction'] in ('row', 'column') and 0 < node['splitPercentage'] < 100
        yield from panels(node['first'])
        yield from panels(node['second'])


def foxglove_paths() -> Iterator[str]:
    """Yield all topics and message paths in it."""
    for config in foxglove()['configById'].values():
        yield from (path['value'] for path in config.get('paths', []))
        yield from config.get('topics', {})
        yield from filter(None, (config.get('topicPath'), config.get('topicToRender')))


def curves() -> list[str]:
    """Return all curves of the PlotJuggler layout."""
    root = ElementTree.parse(CONFIG / 'plotjuggler_layout.xml').getroot()
    return [curve.get('name') for curve in root.iter('curve')]


def follow(kind: type, fields: list[str]) -> Any:
    """Return a field of a message by its path; AttributeError or IndexError without one."""
    value = kind()
    for name in fields:
        value = value[int(name)] if name.isdigit() else getattr(value, name)
    return value


def test_every_panel_is_shown_and_described():
    """And each of them once."""
    shown = list(panels(foxglove()['layout']))
    assert sorted(shown) == sorted(foxglove()['configById'])


@pytest.mark.parametrize('path', sorted(set(foxglove_paths())))
def test_foxglove_shows_what_is_published(path):
    """Topic and field exist."""
    topic, *fields = path.removeprefix('/').split('.', 1)
    words = re.findall(r'\w+', fields[0]) if fields and '{' not in path else []
    follow(ALL_TOPICS[topic], words)


def test_plots_use_no_functions():
    """Foxglove has .@rpy and .@degrees, which Lichtblick does not have."""
    assert not [path for path in foxglove_paths() if '@' in path]


def test_the_3d_panel_shows_the_height_and_follows_the_vehicle():
    """By the frame that the driver publishes."""
    panel = foxglove()['configById']['3D!attitude']
    assert {ALL_TOPICS[topic.removeprefix('/')] for topic in panel['topics']} == IN_3D
    assert panel['followTf'] == parameter_table().values({})['base_frame_id']


def test_foxglove_shows_the_integrity_of_every_signal():
    """And of no other."""
    names = re.findall(r'name=="(\w+)"', (CONFIG / 'foxglove_layout.json').read_text()
                       .replace('\\"', '"'))
    assert names == [*Inertial.SIGNALS, *Navigation.SIGNALS]


@pytest.mark.parametrize('curve', sorted(set(curves())))
def test_plotjuggler_shows_what_is_published(curve):
    """Topic and field exist."""
    topic = max((name for name in TOPICS if curve.startswith(f'/{name}/')), key=len)
    *parents, last = curve.removeprefix(f'/{topic}/').split('/')
    parent = follow(ALL_TOPICS[topic], parents)
    assert hasattr(parent, last)


@pytest.mark.parametrize('paths, separator', [(foxglove_paths(), '.'), (curves(), '/')])
def test_attitude_is_shown_by_its_own_topic(paths, separator):
    """Each tool has its own names for the angles that it makes of a quaternion."""
    assert {path for path in paths if 'attitude' in path} == {
        separator.join(('/attitude/rpy', 'vector', axis)) for axis in 'xyz'}


def test_plotjuggler_layout_is_whole():
    """Every splitter has a size for each of its areas."""
    root = ElementTree.parse(CONFIG / 'plotjuggler_layout.xml').getroot()
    for splitter in root.iter('DockSplitter'):
        sizes = [float(size) for size in splitter.get('sizes').split(';')]
        assert len(sizes) == int(splitter.get('count')) == len(splitter.findall('DockArea'))
        assert sum(sizes) == pytest.approx(1, abs=1e-3)
