# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What /diagnostics says about one driver, of all that publish there.

A status comes from anybody, and says anything. Here it is made safe: texts are printable and not
long, tasks and values are not many.
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
EVENTS = 50
MOST_TASKS = 16
MOST_VALUES = 64
LONGEST_NAME = 60           # characters


class Status(NamedTuple):
    """One task, in texts that may be shown."""

    level: bytes
    message: str
    values: Mapping[str, str]


class Health:
    """Keeps the statuses of the driver that is chosen."""

    def __init__(self, choice: NodeChoice) -> None:
        self.choice = choice
        self.tasks: dict[str, Status] = {}
        self.events: deque[tuple[float, str, Status]] = deque(maxlen=EVENTS)
        self.shared_name = False            # two drivers go by the name that was chosen
        self._heard_at = -math.inf
        self._hardware_ids: list[str] = []  # the latest last

    @property
    def age(self) -> float:
        """Seconds since the latest status; infinite if there was none."""
        return time.monotonic() - self._heard_at

    def update(self, array: DiagnosticArray) -> None:
        """Keep what a message says about the driver."""
        nodes: dict[str, dict[str, DiagnosticStatus]] = {}
        for status in array.status:
            node, task = parse_status_name(status.name)
            if node:
                nodes.setdefault(node, {})[task] = status
        now = time.monotonic()
        self.choice.offer((node for node, tasks in nodes.items() if _of_driver(node, tasks)), now)
        for task, status in islice(nodes.get(self.choice.chosen, {}).items(), MOST_TASKS):
            self._heard_at = now
            self._note(printable(task, LONGEST_NAME), status)

    def _note(self, task: str, status: DiagnosticStatus) -> None:
        self._look_at_hardware(printable(status.hardware_id))
        if task not in self.tasks and len(self.tasks) >= MOST_TASKS:
            return
        before, shown = self.tasks.get(task), _shown(status)
        if before is not None and before.level != shown.level:
            self.events.appendleft((time.time(), task, shown))
        self.tasks[task] = shown

    def _look_at_hardware(self, hardware_id: str) -> None:
        # A driver keeps it; one that was started again may have another, but not the old one.
        if hardware_id not in self._hardware_ids:
            self._hardware_ids = [*self._hardware_ids[-1:], hardware_id]
        elif hardware_id != self._hardware_ids[-1]:
            self.shared_name = True


def _of_driver(node: str, tasks: Mapping[str, DiagnosticStatus]) -> bool:
    return split_name(node)[0] == USUAL_NAME or tasks.keys() >= COMMON_TASKS


def _shown(status: DiagnosticStatus) -> Status:
    return Status(status.level, printable(status.message), {
        printable(item.key, LONGEST_NAME): printable(item.value)
        for item in islice(status.values, MOST_VALUES)})
