# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Reject the parameter use_sim_time, which every node has and a driver of hardware cannot follow.

A real device measures in real time: data and diagnostics carry the time of the host, not of
/clock.
"""

from collections.abc import Sequence

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

NAME = 'use_sim_time'
REASON = ('a real device measures in real time, so stamps are those of the host clock and do '
          'not follow /clock')


def keep_host_time(node: Node) -> None:
    """Warn if a node was started with use_sim_time, and reject further changes of it."""
    at_start = node.get_parameter(NAME).value
    if at_start:
        node.get_logger().warning(f'parameter {NAME} has no effect: {REASON}')

    def check(parameters: Sequence[Parameter]) -> SetParametersResult:
        changed = any(parameter.name == NAME and parameter.value != at_start
                      for parameter in parameters)
        return SetParametersResult(
            successful=not changed,
            reason=f'{NAME} cannot be changed: {REASON}' if changed else '')

    # rclpy calls it before its own callback, which applies the change.
    node.add_on_set_parameters_callback(check)
