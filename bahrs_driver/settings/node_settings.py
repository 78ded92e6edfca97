# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Declare the parameters of the node, with the values that the user gave or the defaults."""

from collections.abc import Iterator
from typing import Generic

from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.group import from_values, GroupType, parameters
from bahrs_driver.settings.parameter import Parameter
from bahrs_driver.settings.parameter_node import ParameterNode
from bahrs_driver.settings.qos_overrides import check_qos_overrides
from bahrs_driver.settings.table import ParameterTable, Settings, unknown_parameter
from bahrs_driver.settings.unused_arguments import unused_arguments
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node


class NodeSettings(Generic[Settings]):
    """The declared parameters of a node, and the settings made from them."""

    def __init__(self, node: ParameterNode, arguments: RosArguments,
                 table: ParameterTable[Settings]) -> None:
        """Declare all parameters on a node; ParameterError if a value is not valid."""
        self._node, self._arguments, self.table = node, arguments, table
        check_qos_overrides(node.given)
        values = table.values(node.given)
        self.sensor, self.settings = table.settings(values)
        for parameter in table:
            node.declare_parameter(parameter.name, values[parameter.name], descriptor(parameter),
                                   ignore_override=True)

    def why_unused(self, name: str) -> str | None:
        """Return why a parameter has no effect; None if it has one."""
        return self.table.why_unused(name, self.sensor, self.settings)

    def warnings(self) -> Iterator[str]:
        """
        Yield warnings about values that are corrected, and about settings without effect.

        Call it after the node has created all publishers, subscriptions and services.
        """
        given = self._node.given
        for parameter in self.table:
            if parameter.name in given:
                correction = parameter.correction(given[parameter.name])
                if correction:
                    yield correction
        unused = [*self.table.unused(given, self.sensor, self.settings), *self._unknown(),
                  *unused_arguments(self._node, self._arguments)]
        if unused:
            yield f'settings without effect: {"; ".join(unused)}'

    def _unknown(self) -> Iterator[str]:
        known = list(self._node.get_parameters_by_prefix(''))
        for name in self._node.given:
            if not self._node.has_parameter(name):
                yield unknown_parameter(name, known)


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """Return the descriptor that `ros2 param describe` shows."""
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    result = ParameterDescriptor(
        name=parameter.name, description=parameter.description + unit,
        read_only=parameter.read_only,
        additional_constraints=f'must be {parameter.valid}' if parameter.choices else '')
    if parameter.low is not None and parameter.high is not None:
        low = 0 if parameter.or_zero else parameter.low
        if isinstance(parameter.default, float):
            result.floating_point_range = [
                FloatingPointRange(from_value=float(low), to_value=float(parameter.high))]
        else:
            result.integer_range = [
                IntegerRange(from_value=int(low), to_value=int(parameter.high), step=1)]
    return result


def read_group(node: Node, kind: type[GroupType], prefix: str) -> GroupType:
    """Read the current values of the parameters of a group."""
    return from_values(kind, {parameter.name: node.get_parameter(parameter.name).value
                              for parameter in parameters(kind(), prefix)}, prefix)
