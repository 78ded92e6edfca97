# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check the diagnostics of running drivers: a driver with an open port knows its problems."""

from collections.abc import Iterator, Sequence
import shlex
import time

from bahrs_driver.diagnostics.names import parse_status_name
from bahrs_driver.doctor.check_result import advice, CheckResult, ok, problem
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

DIAGNOSTICS = '/diagnostics'
TIMEOUT = 3.0              # s; a driver reports once a second
_PROFILE = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)


class DriverStatuses:
    """The latest statuses of some drivers, given by their fully qualified names."""

    def __init__(self, drivers: Sequence[str]) -> None:
        self._drivers = drivers
        self._statuses: dict[str, dict[str, DiagnosticStatus]] = {}

    @property
    def complete(self) -> bool:
        """Whether all drivers have reported."""
        return len(self._statuses) == len(self._drivers)

    def add(self, data: bytes) -> None:
        """Add the statuses of a serialized message."""
        try:
            array = deserialize_message(data, DiagnosticArray)
        except Exception:       # malformed bytes raise exceptions of many kinds
            return
        for status in array.status:
            driver, task = parse_status_name(status.name)
            if driver in self._drivers:
                self._statuses.setdefault(driver, {})[task] = status

    def results(self) -> Iterator[CheckResult]:
        """Yield the errors of each driver."""
        for driver in self._drivers:
            command = shlex.join(['bahrs', 'monitor', '--node', driver])
            statuses = self._statuses.get(driver, {})
            errors = [(task, status) for task, status in statuses.items()
                      if status.level == DiagnosticStatus.ERROR]
            for task, status in errors:
                yield problem('health', f'{driver} reports: {task}: {status.message}', command)
            if not statuses:
                yield advice('health', f'{driver} reports nothing on {DIAGNOSTICS}', command)
            elif not errors:
                yield ok('health', f'{driver} reports no error')


def check(node: Node, drivers: Sequence[str], timeout: float = TIMEOUT) -> Iterator[CheckResult]:
    """Wait until all drivers have reported, at most timeout seconds, and yield their errors."""
    statuses = DriverStatuses(drivers)
    subscription = node.create_subscription(
        DiagnosticArray, DIAGNOSTICS, statuses.add, _PROFILE, raw=True)
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    end = time.monotonic() + timeout
    while not statuses.complete and (left := end - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=left)
    executor.remove_node(node)
    node.destroy_subscription(subscription)
    yield from statuses.results()
