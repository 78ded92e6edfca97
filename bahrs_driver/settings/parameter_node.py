# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A node that knows the parameter values that the user gave."""

from collections.abc import Sequence
from typing import Any

from bahrs_driver.settings.command_line import RosArguments
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter


class ParameterNode(Node):
    """
    A node that keeps the values of its command line and parameter files in `given`.

    rclpy offers no other access to them than declaring all of them, even unknown ones, when it
    creates a node. This class overrides the method that rclpy calls for that.
    """

    def __init__(self, arguments: RosArguments, context: Context | None = None) -> None:
        self.given: dict[str, object] = {}
        self._is_created = False
        super().__init__('bahrs_driver', context=context, cli_args=arguments.node_arguments(),
                         automatically_declare_parameters_from_overrides=True)
        self._is_created = True

    def declare_parameters(self, namespace: str, parameters: Sequence[tuple[Any, ...]],
                           ignore_override: bool = False) -> list[Parameter]:
        """Declare parameters; store the given values instead if rclpy is creating the node."""
        if ignore_override and not self._is_created:
            self.given = {name: value for name, value, _ in parameters}
            return []
        return list(super().declare_parameters(namespace, list(parameters), ignore_override))
