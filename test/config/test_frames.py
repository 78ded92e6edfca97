# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the displays for RViz and of the frames for vehicle descriptions."""

from pathlib import Path
from xml.etree import ElementTree

from bahrs_driver.convert.values import Odometry, PoseWithCovarianceStamped
from bahrs_driver.devices.registry import all_topics, DEVICES, parameter_table
import pytest
import xacro
import yaml

ROOT = Path(__file__).resolve().parents[2]
DEFAULTS = parameter_table().values({})
# Displays of rviz_default_plugins, each with the type of its topic.
DISPLAYS = {'Axes': None, 'Grid': None, 'TF': None, 'Odometry': Odometry,
            'PoseWithCovariance': PoseWithCovarianceStamped}
XACRO = '{http://www.ros.org/wiki/xacro}'


def rviz():
    """Return the displays and the options of RViz."""
    manager = yaml.safe_load((ROOT / 'rviz' / 'bahrs.rviz').read_text())['Visualization Manager']
    return manager['Displays'], manager


@pytest.mark.parametrize('display', rviz()[0], ids=lambda display: display['Name'])
def test_rviz_shows_what_is_published(display):
    """Displays are RViz's own; a relative topic follows the namespace."""
    package, _, name = display['Class'].partition('/')
    assert package == 'rviz_default_plugins' and display['Enabled'] and display['Value']
    kind = DISPLAYS[name]
    assert ('Topic' in display) == bool(kind)
    if kind:
        assert all_topics()[display['Topic']['Value']] is kind


def test_rviz_uses_the_frames_of_the_driver():
    """As it names them by default."""
    displays, manager = rviz()
    assert manager['Global Options']['Fixed Frame'] == DEFAULTS['world_frame_id']
    assert manager['Views']['Current']['Target Frame'] == DEFAULTS['base_frame_id']
    (axes,) = (display for display in displays if display['Class'].endswith('/Axes'))
    assert axes['Reference Frame'] == DEFAULTS['base_frame_id']


@pytest.mark.parametrize('device', DEVICES)
def test_a_frame_for_vehicle_descriptions(device):
    """By default it is that of the driver, in that of the vehicle; it has no made-up mass."""
    tree = ElementTree.parse(ROOT / 'urdf' / f'{device}.urdf.xacro')
    macro = tree.find(f'{XACRO}macro')
    assert macro.get('name') == device
    assert macro.get('params') == (f"link:={DEFAULTS['frame_id']} "
                                   f"parent:={DEFAULTS['base_frame_id']} *origin")
    assert [item.tag for item in macro] == ['link', 'joint'] and not list(macro.find('link'))


@pytest.mark.parametrize('device', DEVICES)
def test_xacro_expands_the_frame(device):
    """Into a link and a fixed joint at the given place."""
    document = xacro.parse(
        '<robot name="uav" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base_link"/>'
        f'<xacro:include filename="{ROOT}/urdf/{device}.urdf.xacro"/>'
        f'<xacro:{device} link="nose"><origin xyz="1 2 3"/></xacro:{device}></robot>')
    xacro.process_doc(document)
    robot = ElementTree.fromstring(document.toxml())
    assert [link.get('name') for link in robot.iter('link')] == ['base_link', 'nose']
    (joint,) = robot.iter('joint')
    assert joint.get('type') == 'fixed' and joint.find('origin').get('xyz') == '1 2 3'
    assert (joint.find('parent').get('link'), joint.find('child').get('link')) == (
        'base_link', 'nose')
