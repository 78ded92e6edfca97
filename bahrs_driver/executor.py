# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Runs a node's callbacks in a few threads, and ends only when the last of them has ended.

The multi-threaded executor of rclpy does not wait for them: one that is still at work when it is
shut down finds what it uses gone, and says so to whoever started the node.
"""

from concurrent.futures import ThreadPoolExecutor

from rclpy.executors import Executor, ShutdownException, TimeoutException
from rclpy.task import Task


class PatientExecutor(Executor):
    """An executor with threads of its own. spin_once() and shutdown() belong to one thread."""

    def __init__(self, threads: int) -> None:
        """Take how many callbacks may run at once."""
        super().__init__()
        self._pool = ThreadPoolExecutor(threads)
        self._begun: list[Task] = []

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """
        Wait for a callback that is due, and begin it.

        What an earlier one raised is raised here.
        """
        try:
            task, _, _ = self.wait_for_ready_callbacks(timeout_sec)
        except (ShutdownException, TimeoutException):
            return
        self._pool.submit(task)
        self._begun = [begun for begun in (*self._begun, task) if not _ended(begun)]

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Begin nothing more, and wait for all that was begun, however long it takes."""
        self._pool.shutdown()
        return bool(super().shutdown(timeout_sec))


def _ended(task: Task) -> bool:
    if task.done():
        task.result()
        return True
    return False
