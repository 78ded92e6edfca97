# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
An executor that survives a failing callback, and that another thread can stop.

docs/decisions/executor.md compares it with the executors of rclpy.
"""

from collections.abc import Callable
import contextlib
import threading
from typing import Protocol

from rclpy.callback_groups import CallbackGroup
from rclpy.context import Context
from rclpy.executors import (
    Executor, ExternalShutdownException, ShutdownException, TimeoutException,
)
from rclpy.task import Task

RETRY_PERIOD = 0.1          # s, before waiting for callbacks again after that failed

ErrorHandler = Callable[[BaseException], None]


class Entity(Protocol):
    """An object with a callback: a timer, subscription, service or client."""

    callback_group: CallbackGroup


class StoppableExecutor(Executor):
    """Runs callbacks one after the other in the thread that calls spin(), until stop()."""

    def __init__(self, on_error: ErrorHandler, context: Context | None = None) -> None:
        """Call on_error with every exception that a callback raises."""
        super().__init__(context=context)
        self._on_error = on_error
        self._stopping = threading.Event()

    def spin(self) -> None:
        """Run callbacks until stop() is called or the context is shut down."""
        while not self._stopping.is_set():
            try:
                self.spin_once()
            except ExternalShutdownException:
                return
            except Exception as error:
                self._on_error(error)
                self._stopping.wait(RETRY_PERIOD)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run the next callback that is due; a timeout in seconds is on steady time."""
        with contextlib.suppress(ShutdownException, TimeoutException):
            self._run(*self.wait_for_ready_callbacks(timeout_sec)[:2])

    def stop(self) -> None:
        """End spin() soon, after the responses of services that are complete. Thread-safe."""
        # The first task runs in one pass with every coroutine that can continue. The second one,
        # which ends spin(), runs in a later pass.
        self.create_task(self.create_task, self._stopping.set)

    def can_execute(self, entity: Entity) -> bool:  # type: ignore[override]
        """Return whether the callback group of an entity is free."""
        # rclpy also skips an entity if it has begun to take its message. With one thread, taking
        # has finished by now, or has failed.
        return bool(entity.callback_group.can_execute(entity))

    def _run(self, task: Task, entity: Entity | None) -> None:
        try:
            task()
            error = task.exception() if task.done() else None
        except BaseException as raised:     # such as SystemExit, which a task lets through
            error = raised
        if error is None:
            return
        if entity is not None and not entity.callback_group.can_execute(entity):
            # rclpy could not take the message, and left the callback group occupied.
            entity.callback_group.ending_execution(entity)
        self._on_error(error)
