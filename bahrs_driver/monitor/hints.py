# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Say what to check if the driver or its topics are not found."""

import os

from bahrs_driver.monitor.watch import Watch
from bahrs_driver.process.printable import printable


def discovery_hint(watch: Watch) -> str:
    """Return what to check; empty if one driver and its topics were found."""
    if not watch.driver_seen:
        return no_driver_hint(watch)
    if watch.health.shared_name:
        return shared_name_hint(watch)
    return '' if watch.has_topics else no_topics_hint(watch)


def no_driver_hint(watch: Watch) -> str:
    """Return what to check if no driver was seen."""
    domain = printable(os.environ.get('ROS_DOMAIN_ID') or '0')
    selection = watch.choice.selection
    which = f' with the {selection}' if any(selection) else ''
    return f'is driver_node running{which}, and is ROS_DOMAIN_ID ({domain} here) the same?'


def no_topics_hint(watch: Watch) -> str:
    """Return what to check if a driver was seen, but none of its topics."""
    return f'{watch.driver} publishes none of its topics in {printable(watch.namespace)}: are ' \
           f'they remapped? See "ros2 node info {watch.driver}"'


def shared_name_hint(watch: Watch) -> str:
    """Return the remedy for two drivers of the same name."""
    return f'two drivers are named {watch.driver}: start one with -r __node:=NAME, or in a ' \
           'namespace'
