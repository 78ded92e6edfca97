# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What drivers that run report on /diagnostics: one that has the port knows why no data comes."""

from collections.abc import Iterator, Sequence
import shlex
import time

from bahrs_driver.diagnostics.names import parse_status_name
from bahrs_driver.doctor.finding import advice, Finding, good, problem
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

DIAGNOSTICS = '/diagnostics'
PATIENCE = 3.0              # s; a driver reports once a second
_PROFILE = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)


class Reports:
    """Collects the statuses of some drivers, given by their fully qualified names."""

    def __init__(self, drivers: Sequence[str]) -> None:
        self._drivers = drivers
        self._heard: dict[str, dict[str, DiagnosticStatus]] = {}

    @property
    def complete(self) -> bool:
        """Whether all drivers have reported."""
        return len(self._heard) == len(self._drivers)

    def add(self, data: bytes) -> None:
        """Keep the statuses in a serialised message."""
        try:
            array = deserialize_message(data, DiagnosticArray)
        except Exception:       # what rmw and rosidl raise for bytes that are no such message
            return
        for status in array.status:
            driver, task = parse_status_name(status.name)
            if driver in self._drivers:
                self._heard.setdefault(driver, {})[task] = status

    def findings(self) -> Iterator[Finding]:
        """Yield the errors of each driver."""
        for driver in self._drivers:
            command = shlex.join(['bahrs', 'monitor', '--node', driver])
            statuses = self._heard.get(driver, {})
            errors = [(task, status) for task, status in statuses.items()
                      if status.level == DiagnosticStatus.ERROR]
            for task, status in errors:
                yield problem('health', f'{driver} reports: {task}: {status.message}', command)
            if not statuses:
                yield advice('health', f'{driver} reports nothing on {DIAGNOSTICS}', command)
            elif not errors:
                yield good('health', f'{driver} reports no error')


def look(node: Node, drivers: Sequence[str], seconds: float = PATIENCE) -> Iterator[Finding]:
    """Listen until all drivers have reported, a time at most, and yield their errors."""
    reports = Reports(drivers)
    subscription = node.create_subscription(
        DiagnosticArray, DIAGNOSTICS, reports.add, _PROFILE, raw=True)
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    end = time.monotonic() + seconds
    while not reports.complete and (left := end - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=left)
    executor.remove_node(node)
    node.destroy_subscription(subscription)
    yield from reports.findings()
