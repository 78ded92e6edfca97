# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Keep the diagnostics of one driver.

Any node may publish any status on /diagnostics. So texts are made printable and truncated, and the
numbers of tasks and values are limited.
"""

from collections import deque
from collections.abc import Mapping
from itertools import islice
import math
import time
from typing import NamedTuple

from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.names import parse_status_name
from bahrs_driver.diagnostics.publishing_task import PublishingTask
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import NodeChoice, split_name, USUAL_NAME
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

# Tasks of every driver: a node of another name that has all of them is a driver.
COMMON_TASKS = {task.name for task in (FramingTask, TimeTask, RatesTask, PublishingTask)}
MAX_EVENTS = 50
MAX_TASKS = 16
MAX_VALUES = 64
MAX_NAME_LENGTH = 60           # characters


class TaskStatus(NamedTuple):
    """The status of a diagnostic task; its texts are printable."""

    level: bytes
    message: str
    values: Mapping[str, str]


class DriverHealth:
    """Keeps the statuses of the chosen driver, and offers all drivers to the choice."""

    def __init__(self, choice: NodeChoice) -> None:
        self.choice = choice
        self.tasks: dict[str, TaskStatus] = {}
        # System time, task and new status of each change of level, the latest first.
        self.events: deque[tuple[float, str, TaskStatus]] = deque(maxlen=MAX_EVENTS)
        self.shared_name = False            # two drivers have the chosen name
        self._updated_at = -math.inf
        self._hardware_ids: list[str] = []  # the latest last

    @property
    def age(self) -> float:
        """Seconds since the latest status; infinite if there was none."""
        return time.monotonic() - self._updated_at

    def update(self, array: DiagnosticArray) -> None:
        """Keep the statuses of the chosen driver in a message."""
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
        before, after = self.tasks.get(task), _task_status(status)
        if before is not None and before.level != after.level:
            self.events.appendleft((time.time(), task, after))
        self.tasks[task] = after

    def _check_hardware(self, hardware_id: str) -> None:
        # A restart may change the id of a driver, but the id before does not return.
        if hardware_id not in self._hardware_ids:
            self._hardware_ids = [*self._hardware_ids[-1:], hardware_id]
        elif hardware_id != self._hardware_ids[-1]:
            self.shared_name = True


def _is_driver(node: str, tasks: Mapping[str, DiagnosticStatus]) -> bool:
    return split_name(node)[0] == USUAL_NAME or tasks.keys() >= COMMON_TASKS


def _task_status(status: DiagnosticStatus) -> TaskStatus:
    return TaskStatus(status.level, printable(status.message), {
        printable(item.key, MAX_NAME_LENGTH): printable(item.value)
        for item in islice(status.values, MAX_VALUES)})
