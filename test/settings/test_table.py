# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the parameter table, of typed settings, and of the parameter files."""

from dataclasses import dataclass
from pathlib import Path

from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.errors import ParameterError
from bahrs_driver.settings.group import setting
from bahrs_driver.settings.node_settings import descriptor
from bahrs_driver.settings.parameter import Parameter
from bahrs_driver.settings.table import ParameterTable
from mypy import api as mypy
import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
BY_NAME = parameter_table().by_name


@pytest.mark.parametrize('parameter', BY_NAME.values(), ids=lambda parameter: parameter.name)
def test_every_row_is_complete(parameter):
    """Each has a sentence as description, a valid default, and a descriptor with its limits."""
    assert parameter.description.endswith('.')
    parameter.convert(parameter.default)
    described = descriptor(parameter)
    assert parameter.description in described.description
    assert described.read_only == (parameter.name not in (
        'nvm.page', 'nvm.dump_path', 'nvm.enter_timeout', 'nvm.service_frames'))
    if isinstance(parameter.default, float):
        assert described.floating_point_range[0].to_value == parameter.high
    for choice in parameter.choices:
        assert choice in described.additional_constraints


def test_devices_share_parameters_or_differ_in_names():
    """Two devices must not define different parameters of one name."""
    @dataclass(frozen=True)
    class Other(CommonSettings):
        baud_rate: int = setting(9600, 'Another speed.')

    with pytest.raises(ValueError, match='two devices define the parameter baud_rate'):
        ParameterTable({'one': CommonSettings, 'other': Other})
    assert 'port' in ParameterTable({'one': CommonSettings, 'other': CommonSettings}).by_name


@pytest.mark.parametrize('expression, error', [
    ('settings.time.source', ''),
    ('settings.time.sauce', 'error: "Time" has no attribute "sauce"'),
    ('settings.time.source == "arival"', 'error: Non-overlapping equality check'),
    ('settings.stddev.velocity + settings.port', 'error: Unsupported operand types'),
])
def test_mypy_checks_settings(tmp_path, expression, error):
    """It finds a wrong name, a wrong choice and a wrong type."""
    file = tmp_path / 'snippet.py'
    file.write_text('from bahrs_driver.devices.settings import CommonSettings\n'
                    f'def f(settings: CommonSettings) -> object: return {expression}\n')
    report, _, status = mypy.run(['--config-file', str(ROOT / 'setup.cfg'), str(file)])
    assert error in report and bool(status) == bool(error), report


@pytest.mark.parametrize('name, value, sentence', [
    ('baud_rate', 300, 'parameter baud_rate is 300: it must be a whole number from 1200 to '
                       '4000000 baud'),
    ('baud_rate', '115200', "parameter baud_rate is '115200': it must be a whole number from "
                            '1200 to 4000000 baud'),
    ('frame_convention', 'ENU', "parameter frame_convention is 'ENU': it must be 'enu' or 'ned'"),
    ('frame_id', '', "parameter frame_id is '': it must be the name of a frame without blanks, "
                     "such as 'imu_link'"),
    ('world_frame_id', '//', "parameter world_frame_id is '//': it must be the name of a frame "
                             "without blanks, such as 'odom'"),
    ('port', ' ', "parameter port is ' ': it must be a text such as '/dev/ttyUSB0'"),
    ('stddev.velocity', 10 ** 400, 'parameter stddev.velocity is ' + '1' + '0' * 78 + '…: it must '
                                   'be a decimal number from 0.0 to 100.0 m/s'),
    ('port', None, "parameter port is []: it must be a text such as '/dev/ttyUSB0'"),
    ('stddev.velocity', float('nan'), 'parameter stddev.velocity is nan: it must be a decimal '
                                      'number from 0.0 to 100.0 m/s'),
    ('publish.derived_magnetic_field', 1, 'parameter publish.derived_magnetic_field is 1: it '
                                          'must be true or false'),
])
def test_a_bad_value_gives_one_sentence(name, value, sentence):
    """It names the parameter, its value, and the valid values."""
    with pytest.raises(ParameterError) as caught:
        BY_NAME[name].convert(value)
    assert str(caught.value) == sentence


@pytest.mark.parametrize('given, frames', [
    ({}, ('imu_link', 'odom')),
    ({'frame_convention': 'ned'}, ('imu_link_ned', 'map_ned')),
    ({'frame_convention': 'ned', 'frame_id': 'imu_link'}, ('imu_link', 'map_ned')),
    ({'frame_convention': 'ned', 'world_frame_id': 'odom'}, ('imu_link_ned', 'odom'))])
def test_default_frames_have_the_axes_of_the_convention(given, frames):
    """A frame that is given stays."""
    values = parameter_table().values(given)
    assert (values['frame_id'], values['world_frame_id']) == frames


@pytest.mark.parametrize('value', ['nan', float('nan')])
def test_a_choice_that_yaml_takes_for_a_number(value):
    """It may be written as in the documentation."""
    assert BY_NAME['publish.incomplete'].convert(value) == 'nan'


def test_true_is_not_a_number():
    """Although bool is a subclass of int."""
    with pytest.raises(ParameterError):
        Parameter('n', 3, 'A number.', low=0, high=9).convert(True)


def flat(tree, prefix=''):
    """Yield the dotted names and values of nested dictionaries."""
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flat(value, f'{prefix}{key}.')
        else:
            yield prefix + key, value


@pytest.mark.parametrize('path', sorted((ROOT / 'config').glob('[bt]*.yaml')),
                         ids=lambda path: path.name)
def test_parameter_files_fit_the_table(path):
    """Every name exists, every value is valid."""
    content = yaml.safe_load(path.read_text())
    for node in content.values():
        for name, value in flat(node['ros__parameters']):
            BY_NAME[name].convert(value)
