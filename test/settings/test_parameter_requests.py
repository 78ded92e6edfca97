# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Requests that set parameters at run time: applied, or refused with the reason."""

import sys

from bahrs_driver.node.driver_node import DriverNode
from hypothesis import given, settings, strategies as st
import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, GetParameterTypes, ListParameters, SetParameters,
    SetParametersAtomically,
)
import rclpy

BOOL, INTEGER, DOUBLE, STRING, BYTE_ARRAY = 1, 2, 3, 4, 5


@pytest.fixture(scope='module')
def make_node():
    """Return a function that creates the node with arguments; none of its threads run."""
    nodes, words = [], sys.argv

    def make(*arguments):
        sys.argv = ['driver_node', '--ros-args', *arguments]
        nodes.append(DriverNode())
        return nodes[-1]

    rclpy.init(args=[])
    yield make
    sys.argv = words
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown()


@pytest.fixture(scope='module')
def node(make_node):
    """Return a node for a BAHRS."""
    return make_node('-p', 'baudrate:=5', '-p', 'qos_overrides./imu/data.publisher.depth:=7')


def parameter(name, kind, **value):
    """Return a parameter for a request."""
    return Parameter(name=name, value=ParameterValue(type=kind, **value))


def call(node, kind, **request):
    """Call the only service of a type, and return the response."""
    (service,) = (service for service in node.services if service.srv_type is kind)
    return service.callback(kind.Request(**request), kind.Response())


def answers(node, *parameters):
    """Return the results of both services for the same parameters."""
    return (call(node, SetParameters, parameters=parameters).results,
            call(node, SetParametersAtomically, parameters=parameters).result)


@pytest.mark.parametrize('item, reason', [
    (parameter('port', STRING, string_value='/dev/x'),
     'parameter port is read when the driver starts: restart it with -p port:=VALUE'),
    (parameter('baudrate', INTEGER, integer_value=5),
     'cannot set baudrate (there is no such parameter, did you mean baud_rate?)'),
    (parameter('state.rate', DOUBLE, double_value=5.0),
     'parameter state.rate has no effect: sensor is bahrs'),
    (parameter('nvm.page', INTEGER, integer_value=250),
     'parameter nvm.page is 250: it must be a whole number from 0 to 249'),
    (parameter('nvm.page', STRING, string_value='5'),
     "parameter nvm.page is '5': it must be a whole number from 0 to 249"),
    (parameter('nvm.page', 0), 'parameter nvm.page is []: it must be a whole number'),
    (parameter('nvm.dump_path', STRING, string_value=' '),
     "parameter nvm.dump_path is ' ': it must be a text such as"),
    (parameter('nvm.page', 77), 'parameter nvm.page cannot have a value of type 77: '),
    (parameter('qos_overrides./imu/data.publisher.depth', INTEGER, integer_value=5),
     'read-only parameter'),
    (parameter('qos_overrides./imu/dta.publisher.depth', INTEGER, integer_value=5),
     'cannot set qos_overrides./imu/dta.publisher.depth (there is no such publisher'),
])
def test_refused(node, item, reason):
    """By both services, with the reason and the remedy."""
    each, together = answers(node, item)
    for result in (*each, together):
        assert not result.successful and reason in result.reason


def test_of_another_device(make_node):
    """The reason names the device, not the value."""
    node = make_node('-p', 'sensor:=titan_m', '-r', '__node:=titan_m')
    (result,), _ = answers(node, parameter('nvm.page', INTEGER, integer_value=5))
    assert result.reason == 'parameter nvm.page has no effect: sensor is titan_m'


def test_applied(node):
    """A parameter that a service reads at each call."""
    each, together = answers(node, parameter('nvm.page', INTEGER, integer_value=5))
    assert together.successful and all(result.successful for result in each)
    assert node.get_parameter('nvm.page').value == 5


def test_one_that_is_refused_is_for_all(node):
    """If they are set together; otherwise each has its own result."""
    good = parameter('nvm.page', INTEGER, integer_value=6)
    each, together = answers(node, good, parameter('nvm.page', 99), good)
    assert [result.successful for result in each] == [True, False, True]
    assert not together.successful


TEXTS = st.text(st.characters(exclude_categories=['Cs'], exclude_characters='\0'), max_size=10)
INTEGERS = st.integers(-2 ** 63, 2 ** 63 - 1)
VALUES = st.builds(
    ParameterValue, type=st.integers(0, 255), bool_value=st.booleans(), integer_value=INTEGERS,
    double_value=st.floats(), string_value=TEXTS, integer_array_value=st.lists(INTEGERS),
    byte_array_value=st.lists(st.binary(min_size=1, max_size=1), max_size=3),
    bool_array_value=st.lists(st.booleans(), max_size=3),
    double_array_value=st.lists(st.floats(), max_size=3),
    string_array_value=st.lists(TEXTS, max_size=3))
NAMES = st.one_of(TEXTS, st.sampled_from([
    'nvm.page', 'nvm.dump_path', 'port', 'sensor', 'start_type_description_service',
    'qos_overrides./imu/data.publisher.depth', 'qos_overrides./raw.publisher.depth']))
SETTABLE = {'nvm.page', 'nvm.dump_path', 'nvm.enter_timeout', 'nvm.service_frames'}


@settings(max_examples=200)
@given(items=st.lists(st.builds(Parameter, name=NAMES, value=VALUES), max_size=4))
def test_any_request(node, items):
    """Each parameter has a result; only valid values of settable parameters are applied."""
    before = dict(node.get_parameters_by_prefix(''))
    each, together = answers(node, *items)
    assert len(each) == len(items)
    for item, result in zip(items, each):
        assert result.successful or result.reason
        assert not result.successful or item.name in SETTABLE
    after = node.get_parameters_by_prefix('')
    assert before.keys() == after.keys()
    for name in before.keys() - SETTABLE:
        assert before[name].value == after[name].value
    assert 0 <= after['nvm.page'].value <= 249 and after['nvm.dump_path'].value.strip()


@settings(max_examples=100)
@given(names=st.lists(NAMES, max_size=4), depth=st.integers(0, 2 ** 64 - 1))
def test_any_question(node, names, depth):
    """The services that read parameters respond, too."""
    for kind in (GetParameters, GetParameterTypes, DescribeParameters):
        call(node, kind, names=names)
    call(node, ListParameters, prefixes=names, depth=depth)
