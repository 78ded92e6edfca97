# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings that a node has with the words of a command line."""

from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.node_settings import NodeSettings
import rclpy
from rclpy.context import Context


def settings_of(words):
    """Return the values of all parameters of a node that is started with a command."""
    arguments = RosArguments.from_words(words)
    context = Context()
    context.init(words)
    node = rclpy.create_node('bahrs_driver', context=context,
                             cli_args=arguments.node_arguments(), start_parameter_services=False)
    try:
        return NodeSettings(node, arguments).values
    finally:
        node.destroy_node()
        context.try_shutdown()
