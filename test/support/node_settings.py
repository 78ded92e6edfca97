# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a node that is started with a command line."""

from typing import Any

from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.node_settings import NodeSettings
from bahrs_driver.settings.parameter_node import ParameterNode
from rclpy.context import Context


def node_settings(words: list[str]) -> tuple[str, Any]:
    """Return the sensor and the settings of a node that is started with a command."""
    arguments = RosArguments.from_words(words)
    context = Context()
    context.init(words)
    node = ParameterNode(arguments, context)
    try:
        given = NodeSettings(node, arguments, parameter_table())
        return given.sensor, given.settings
    finally:
        node.destroy_node()  # type: ignore[no-untyped-call]
        context.try_shutdown()
