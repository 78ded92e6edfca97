# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of the node: declared with the values that the user gave, or the defaults."""

from collections.abc import Iterator, Mapping
from typing import Any

from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.qos_overrides import check_qos_overrides
from bahrs_driver.settings.table import PARAMETERS
from bahrs_driver.settings.unused import unknown_parameter, unused_parameters
from bahrs_driver.settings.unused_arguments import unused_arguments
from rclpy.node import Node


class NodeSettings:
    """What the user gave to a node, and the values of all parameters."""

    def __init__(self, node: Node, arguments: RosArguments) -> None:
        """Declare all parameters on a node; ParameterError if a value is not valid."""
        self._node = node
        self._arguments = arguments
        # rclpy has no public name for it, and would declare what does not exist.
        self._given: dict[str, Any] = {
            name: parameter.value for name, parameter in node._parameter_overrides.items()}
        check_qos_overrides(self._given)
        self.values: Mapping[str, Any] = {
            parameter.name: parameter.convert(self._given[parameter.name])
            if parameter.name in self._given else parameter.default for parameter in PARAMETERS}
        for parameter in PARAMETERS:
            node.declare_parameter(parameter.name, self.values[parameter.name],
                                   parameter.descriptor(), ignore_override=True)

    def warnings(self) -> Iterator[str]:
        """
        Yield sentences about settings that are used in another form, or not at all.

        The node must have all its publishers, subscriptions and services.
        """
        for parameter in PARAMETERS:
            if parameter.name in self._given:
                correction = parameter.correction(self._given[parameter.name])
                if correction:
                    yield correction
        unused = [*unused_parameters(self._given, self.values), *self._unknown(),
                  *unused_arguments(self._node, self._arguments)]
        if unused:
            yield f'settings without effect: {"; ".join(unused)}'

    def _unknown(self) -> Iterator[str]:
        known = list(self._node.get_parameters_by_prefix(''))
        for name in self._given:
            if not self._node.has_parameter(name):
                yield unknown_parameter(name, known)
