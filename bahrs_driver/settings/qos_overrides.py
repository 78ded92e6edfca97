# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The check of the parameters qos_overrides.TOPIC.publisher.POLICY before rclpy uses them.

rclpy raises exceptions of many kinds for an invalid value, and the middleware logs more lines.
"""

from collections.abc import Mapping

from bahrs_driver.settings.parameter import Parameter
from bahrs_driver.settings.table import QOS_PREFIX

DEEPEST = 2 ** 31 - 1

_CHOICES = {'history': ('keep_last', 'keep_all', 'system_default'),
            'reliability': ('reliable', 'best_effort', 'best_available', 'system_default')}


def check_qos_overrides(given: Mapping[str, object]) -> None:
    """Raise ParameterError if a parameter that overrides a policy is invalid."""
    for name, value in given.items():
        policy = name.rpartition('.')[2]
        if not name.startswith(QOS_PREFIX):
            continue
        if policy == 'depth':
            Parameter(name, 100, '', low=1, high=DEEPEST).convert(value)
        elif policy in _CHOICES:
            Parameter(name, 'keep_last', '', choices=_CHOICES[policy]).convert(
                value.lower() if isinstance(value, str) else value)
