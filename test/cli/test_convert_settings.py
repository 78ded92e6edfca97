# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the parameters of a conversion."""

from pathlib import Path
import re

from bahrs_driver.cli.convert_settings import read_settings
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.devices.registry import DEVICES, parameter_table
from bahrs_driver.errors import CommandError, ParameterError
from hypothesis import given, settings, strategies as st
import pytest
from support.settings_examples import RecordedSettings, values_of

TABLE = parameter_table()
PACKAGE = Path(__file__).resolve().parents[2] / 'bahrs_driver'
# Read by a conversion, not by the parts of a device.
OF_CONVERSION = {'sensor', 'baud_rate'} | {
    name for path in (PACKAGE / 'reprocess').glob('*.py')
    for name in re.findall(r'settings\.([a-z_.]+)', path.read_text())}


def test_valid_values():
    """They are converted as in the node."""
    values, notes = read_settings(
        ['stddev.velocity:=1', 'magnetic_field.strength:=4e-5', 'frame_id:=/imu',
         'frame_convention:=ned', 'crc_order:=word'], 'bahrs')
    assert values.magnetic_field.strength == 4e-5
    assert values.stddev.velocity == 1.0 and values.frame_id == 'imu'
    assert values.crc_order == 'word'
    assert notes == ["parameter frame_id is '/imu': names of frames have no leading slash, 'imu' "
                     'is used']


@pytest.mark.parametrize('rule, sentence', [
    ('frame_id:=my imu', "parameter frame_id is 'my imu': it must be the name of a frame"),
    ('frame_id:=~', None),
    ('frame_id:=[]', 'parameter frame_id is []: it must be'),
    ('baudrate:=5', '-p baudrate:=5: baudrate (there is no such parameter, did you mean baud_'),
    ('stddev.velocity:=.inf', 'parameter stddev.velocity is inf: it must be a decimal number'),
    ('port:=\x1b[2J', r"-p port:=\x1b[2J: '\x1b[2J' is not valid YAML"),
    (':=5', '-p :=5: it must be NAME:=VALUE'),
])
def test_errors(rule, sentence):
    """They name the rule or the parameter."""
    if sentence is None:
        assert read_settings([rule], 'bahrs')[0].frame_id == '~'
        return
    with pytest.raises((CommandError, ParameterError)) as caught:
        read_settings([rule], 'bahrs')
    assert sentence in str(caught.value)


def test_settings_without_effect():
    """One sentence lists them, with those for a port."""
    _, notes = read_settings(['payload_order:=big', 'port:=/dev/x', 'nvm.page:=5'], 'bahrs')
    assert notes == ['settings without effect: payload_order (sensor is bahrs); port (it is for a '
                     'port); nvm.page (it is for a port)']


@settings(max_examples=60)
@given(name=st.sampled_from(sorted(TABLE.by_name)), sensor=st.sampled_from(sorted(DEVICES)),
       data=st.data())
def test_each_parameter_is_read_or_listed(name, sensor, data):
    """Each parameter is set alone to a valid value."""
    value = data.draw(values_of(TABLE.by_name[name]))
    try:
        text = str(value).lower() if isinstance(value, bool) else value
        values, notes = read_settings([f'{name}:={text}'], sensor)
    except ParameterError:
        assert name == 'sensor' or name.endswith('.rate')
        return
    recorded = RecordedSettings(values)
    DEVICES[sensor].parts(recorded)
    if name not in recorded.read | OF_CONVERSION:
        assert any(f'{name} (' in note for note in notes)


@given(rules=st.lists(st.one_of(st.text(max_size=20), st.builds(
    '{}:={}'.format, st.sampled_from(sorted(TABLE.by_name)),
    st.text(max_size=10))), max_size=3))
def test_any_rule(rules):
    """A rule is read, or refused in a printable sentence."""
    try:
        values, notes = read_settings(rules, 'bahrs')
    except (CommandError, ParameterError) as error:
        assert str(error).isprintable()
    else:
        assert isinstance(values, BahrsSettings) and all(map(str.isprintable, notes))
