# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Publish /diagnostics, and serve ~/self_test."""

from collections.abc import Callable
from threading import Lock
import time

from bahrs_driver.convert.values import DiagnosticArray
from bahrs_driver.diagnostics.self_test import answer
from bahrs_driver.diagnostics.updater import Updater
from diagnostic_msgs.srv import SelfTest
from rclpy.publisher import Publisher

TOPIC = '/diagnostics'


class DiagnosticsPublisher:
    """Publishes the reports of an updater, from any thread."""

    def __init__(self, updater: Updater, publisher: Publisher,
                 serialize: Callable[[DiagnosticArray], object],
                 device_id: Callable[[], str]) -> None:
        self._updater = updater
        self._publisher = publisher
        self._serialize = serialize
        self._device_id = device_id
        self._lock = Lock()         # or an older report could overtake a newer one

    def report(self) -> None:
        """Publish a report unless one has just been published; call it every second."""
        with self._lock:
            if self._updater.report_allowed():
                self._publish()

    def report_change(self) -> None:
        """Publish the diagnostics if they changed; a change that comes too soon waits."""
        if self._updater.change_due():
            with self._lock:
                self._publish()

    def self_test(self, _request: SelfTest.Request,
                  response: SelfTest.Response) -> SelfTest.Response:
        """Respond with the result of each task."""
        return answer(self._updater.summaries(), self._updater.hardware_id, self._device_id(),
                      response)

    def _publish(self) -> None:
        self._publisher.publish(self._serialize(
            DiagnosticArray(time.time_ns(), '', self._updater.statuses())))
