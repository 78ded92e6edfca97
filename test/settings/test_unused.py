# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Settings without effect: listed in one warning, with the reason."""

from pathlib import Path
import re

from bahrs_driver.devices.registry import DEVICES, parameter_table
from bahrs_driver.settings.group import parameters
from bahrs_driver.transport.link import Link
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from support.settings_examples import RecordedSettings, values_of
from support.starting import start

PACKAGE = Path(__file__).resolve().parents[2] / 'bahrs_driver'
TABLE = parameter_table()
SILENT = dict.fromkeys(('state.rate', 'sensors.rate', 'gps.rate'), 0.0)


def read_by(file, prefix=''):
    """Return the parameters that a module reads as attributes of `settings`."""
    text = (PACKAGE / file).read_text()
    return {prefix + name for name in re.findall(r'settings(?:\(\))?\.([a-z_.]+)', text)}


# Read by the node and its services, not by the parts of a device.
OF_THE_NODE = {'sensor'} | read_by('node/driver_node.py') | read_by('node/topics.py') | \
    read_by('node/transforms.py') | read_by('devices/mounting.py') | \
    read_by('node/nvm_services.py', 'nvm.') | read_by('devices/nvm_reader.py', 'nvm.')


@settings(max_examples=40)
@given(st.fixed_dictionaries({row.name: values_of(row) for row in TABLE}))
def test_each_parameter_is_read_or_listed(values):
    """For any values."""
    sensor, values = TABLE.settings(values)
    recorded = RecordedSettings(values)
    DEVICES[sensor].parts(recorded).live(Link(values.port, values.baud_rate))
    listed = {name.split()[0] for name in TABLE.unused(TABLE.by_name, sensor, values)}
    assert TABLE.by_name.keys() - recorded.read - OF_THE_NODE <= listed


@pytest.mark.parametrize('sensor', DEVICES)
@settings(max_examples=20)
@given(values=st.fixed_dictionaries({row.name: values_of(row) for row in TABLE}))
def test_each_unused_name_is_a_parameter_of_the_device(sensor, values):
    """A misspelled name would never be listed."""
    _, values = TABLE.settings({**values, 'sensor': sensor})
    assert {name for name, _ in values.unused()} <= {row.name for row in parameters(values)}


@pytest.mark.parametrize('name, values, reason', [
    ('state.rate', {}, 'sensor is bahrs'),
    ('crc_order', {'sensor': 'titan_m'}, 'sensor is titan_m'),
    ('nvm.page', {'sensor': 'titan_m'}, 'sensor is titan_m'),
    ('time.sync_pulse.period', {}, "time.source is 'device'"),
    ('time.sync_pulse.reference', {'time.source': 'arrival'}, "time.source is 'arrival'"),
    ('time.sync_pulse.period', {'time.source': 'sync_pulse'}, None),
    ('time.label', {'time.source': 'arrival'}, "time.source is 'arrival'"),
    ('magnetic_field.dip', {'publish.derived_magnetic_field': False},
     'publish.derived_magnetic_field is False'),
    ('integrity.risk_inflation', {'integrity.risk_policy': 'pass'},
     "integrity.risk_policy is 'pass'"),
    ('mounting.x', {}, 'publish.tf and publish.static_tf are False'),
    ('mounting.x', {'publish.static_tf': True}, None),
    ('base_frame_id', {'publish.tf': True}, None),
    ('publish.tf', {'sensor': 'titan_m', 'state.rate': 0.0}, 'state.rate is 0'),
    ('baud_rate', {'port': 'socket://host:4001'}, 'port is a socket'),
    ('baud_rate', {'port': 'rfc2217://host:4001'}, None),
    ('gps.week', {'sensor': 'titan_m', 'gps.rate': 0.0}, 'gps.rate is 0'),
    ('stddev.temperature', {'sensor': 'titan_m', 'sensors.rate': 0.0}, 'sensors.rate is 0'),
    ('stddev.attitude', {'sensor': 'titan_m', 'state.rate': 0.0}, 'state.rate is 0'),
    ('gps.week', {'sensor': 'titan_m', **SILENT}, None),
    ('request.retries', {'sensor': 'titan_m', **SILENT},
     'state.rate, sensors.rate, gps.rate are 0'),
])
def test_reasons(name, values, reason):
    """They name the deciding parameter."""
    assert TABLE.why_unused(name, *TABLE.settings(TABLE.values(values))) == reason


def test_one_warning_lists_them_all(monkeypatch, capfd, tmp_path):
    """Parameters of the other device, unknown ones, policies of no topic, files for no node."""
    file = tmp_path / 'my.yaml'
    file.write_text('bahrs_driver:\n  ros__parameters:\n    port: /dev/ttyUSB7\n')
    status, lines = start(
        monkeypatch, capfd, '--params-file', str(file), '-r', '__node:=front',
        '-p', 'state.rate:=10', '-p', 'baudrate:=9600', '-p', 'nothing_like_it:=[]',
        '-p', 'time.sync_pulse.period:=1.0', '-p', 'publish.raw:=false',
        '-p', 'qos_overrides./imu/dta.publisher.depth:=5',
        '-p', 'qos_overrides./imu/data.publisher.durability:=volatile',
        '-p', 'qos_overrides./imu/data.publisher.depth:=5')
    assert status == 0 and len(lines) == 1
    for part in ("settings without effect: time.sync_pulse.period (time.source is 'device'); "
                 'state.rate (sensor is bahrs); '
                 'baudrate (there is no such parameter, did you mean baud_rate?); '
                 'nothing_like_it (there is no such parameter); ',
                 'qos_overrides./imu/dta.publisher.depth (there is no such publisher, '
                 'subscription or policy, did you mean qos_overrides./imu/data.publisher.depth?)',
                 'qos_overrides./imu/data.publisher.durability (there is no such',
                 f'parameter file {file} (it has parameters of bahrs_driver only, use the key '
                 '/** or /front)'):
        assert part in lines[0]
    assert 'publish.raw' not in lines[0] and lines[0].count('imu/data.publisher.depth') == 1


@pytest.mark.parametrize('words, reason', [
    (['-r', 'imu/dta:=x'], '-r imu/dta:=x (there is no such topic or service)'),
    (['-r', '/imu/data:=x', '-r', '__ns:=/left'], '-r /imu/data:=x (there is no such topic or'),
    (['-r', 'other:imu/data:=x'], '-r other:imu/data:=x (it is for a node other)'),
    (['-r', 'rostopic://raw:=x'], '-r rostopic://raw:=x (there is no such topic or service)'),
    (['-p', 'front:port:=x'], '-p front:port:=x (it is for node /front)'),
    (['-p', 'front:port:=x', '-r', '__node:=front', '-r', '__ns:=/left'],
     '-p front:port:=x (it is for node /front)'),
])
def test_arguments_without_effect(monkeypatch, capfd, words, reason):
    """Remappings of no topic, and rules for another node."""
    status, lines = start(monkeypatch, capfd, *words)
    assert status == 0 and len(lines) == 1 and f'settings without effect: {reason}' in lines[0]


TOPICS_AND_SERVICES = st.sampled_from([
    'imu/data', '/imu/data', '/diagnostics', 'integrity', '~/self_test', '~/nvm/dump',
    'bahrs_driver/nvm/dump', 'nvm/page', 'rostopic://heading', 'rosservice://~/self_test',
    'bahrs_driver:velocity', 'tf', '/tf_static', '/clock'])


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(names=st.lists(TOPICS_AND_SERVICES, unique=True, max_size=3))
def test_remappings_with_an_effect_are_not_listed(monkeypatch, capfd, names):
    """Nor remappings that a launch file passes to all of its nodes."""
    words = [word for number, name in enumerate(names) for word in ('-r', f'{name}:=x{number}')]
    assert start(monkeypatch, capfd, *words) == (0, [])


def test_nothing_is_listed_for_nothing(monkeypatch, capfd):
    """Settings with an effect cause no warning."""
    assert start(monkeypatch, capfd, '-p', 'time.source:=sync_pulse',
                 '-p', 'time.sync_pulse.reference:=pulses', '-p', 'stddev.velocity:=1',
                 '-p', 'qos_overrides./pulses.subscription.depth:=5',
                 '-p', 'publish.raw:=true', '-p', 'qos_overrides./raw.publisher.depth:=5',
                 '-p', 'qos_overrides./nvm/page.publisher.reliability:=best_effort',
                 '-p', 'qos_overrides./integrity.publisher.depth:=5',
                 ) == (0, [])


def test_a_long_name_is_cut(monkeypatch, capfd):
    """Lines of the log stay short."""
    status, lines = start(monkeypatch, capfd, '-p', f'x{"y" * 5000}:=1')
    assert status == 0 and len(lines) == 1 and len(lines[0]) < 1500


@pytest.mark.parametrize('name', ['bahrs', 'titan_m'])
def test_shipped_files_have_no_setting_without_effect(monkeypatch, capfd, name):
    """For a node of any name in any namespace."""
    file = str(PACKAGE.parent / 'config' / f'{name}.yaml')
    assert start(monkeypatch, capfd, '--params-file', file, '-p', 'port:=/nowhere',
                 '-r', '__node:=front', '-r', '__ns:=/left') == (0, [])
