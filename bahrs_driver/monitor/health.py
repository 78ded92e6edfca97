# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Keep the diagnostics of one driver, of all that are published.

Any node may publish any status. So texts are made printable and cut, and the numbers of tasks and
values are limited.
"""

from collections import deque
from collections.abc import Mapping
from itertools import islice
import math
import time
from typing import NamedTuple

from bahrs_driver.diagnostics.names import parse_status_name
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import NodeChoice, split_name, USUAL_NAME
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

# Tasks of every driver: a node of another name that has all of them is a driver.
COMMON_TASKS = frozenset(('Framing', 'Time', 'Rates', 'Publishing'))
MAX_EVENTS = 50
MAX_TASKS = 16
MAX_VALUES = 64
MAX_NAME_LENGTH = 60           # characters


class ShownStatus(NamedTuple):
    """The status of one task in printable texts."""

    level: bytes
    message: str
    values: Mapping[str, str]


class DriverHealth:
    """Keeps the statuses of the chosen driver; offers the choice all drivers that report."""

    def __init__(self, choice: NodeChoice) -> None:
        self.choice = choice
        self.tasks: dict[str, ShownStatus] = {}
        self.events: deque[tuple[float, str, ShownStatus]] = deque(maxlen=MAX_EVENTS)
        self.shared_name = False            # two drivers have the chosen name
        self._updated_at = -math.inf
        self._hardware_ids: list[str] = []  # the latest last

    @property
    def age(self) -> float:
        """Seconds since the latest status; infinite if there was none."""
        return time.monotonic() - self._updated_at

    def update(self, array: DiagnosticArray) -> None:
        """Keep the statuses of the driver in a message."""
        nodes: dict[str, dict[str, DiagnosticStatus]] = {}
        for status in array.status:
            node, task = parse_status_name(status.name)
            if node:
                nodes.setdefault(node, {})[task] = status
        now = time.monotonic()
        self.choice.offer((node for node, tasks in nodes.items() if _is_driver(node, tasks)), now)
        for task, status in islice(nodes.get(self.choice.chosen, {}).items(), MAX_TASKS):
            self._updated_at = now
            self._keep(printable(task, MAX_NAME_LENGTH), status)

    def _keep(self, task: str, status: DiagnosticStatus) -> None:
        self._check_hardware(printable(status.hardware_id))
        if task not in self.tasks and len(self.tasks) >= MAX_TASKS:
            return
        before, shown = self.tasks.get(task), _shown(status)
        if before is not None and before.level != shown.level:
            self.events.appendleft((time.time(), task, shown))
        self.tasks[task] = shown

    def _check_hardware(self, hardware_id: str) -> None:
        # A driver keeps its id; one that was restarted may have another, but not the old one.
        if hardware_id not in self._hardware_ids:
            self._hardware_ids = [*self._hardware_ids[-1:], hardware_id]
        elif hardware_id != self._hardware_ids[-1]:
            self.shared_name = True


def _is_driver(node: str, tasks: Mapping[str, DiagnosticStatus]) -> bool:
    return split_name(node)[0] == USUAL_NAME or tasks.keys() >= COMMON_TASKS


def _shown(status: DiagnosticStatus) -> ShownStatus:
    return ShownStatus(status.level, printable(status.message), {
        printable(item.key, MAX_NAME_LENGTH): printable(item.value)
        for item in islice(status.values, MAX_VALUES)})
