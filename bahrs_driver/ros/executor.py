# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Executors that survive a failing callback, and that another thread can stop.

Those of rclpy raise what a callback raises, which would end the driver for the sake of one
request. They stop spinning only when a callback becomes due, which a clock that was set back can
put off for hours, and the multi-threaded one is shut down while callbacks still run.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
import contextlib
import threading
from typing import Any
from weakref import WeakSet

from rclpy.context import Context
from rclpy.executors import (
    ConditionReachedException, Executor, ExternalShutdownException, ShutdownException,
    TimeoutException,
)
from rclpy.task import Task

RETRY_PERIOD = 0.1          # s, before waiting for callbacks again after that failed

ErrorHandler = Callable[[BaseException], None]


class StoppableExecutor(Executor):
    """Runs callbacks one after the other in the thread that calls spin(), until stop()."""

    def __init__(self, on_error: ErrorHandler, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._on_error = on_error
        self._stopping = threading.Event()
        # rclpy hands a task out again if its thread has not begun it yet.
        self._lock = threading.Lock()
        self._failed: WeakSet[Task] = WeakSet()

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
        with contextlib.suppress(ShutdownException, TimeoutException, ConditionReachedException):
            self._start(*self.wait_for_ready_callbacks(
                timeout_sec, None, self._stopping.is_set)[:2])

    def stop(self) -> None:
        """End spin() soon. Any thread may call it; callbacks that have begun go on."""
        self._stopping.set()
        self.wake()

    def _start(self, task: Task, entity: Any) -> None:
        self._run(task, entity)

    def _run(self, task: Task, entity: Any) -> None:
        try:
            task()
            error = task.exception() if task.done() else None
        except BaseException as raised:     # such as SystemExit, which a task lets through
            error = raised
        if error is None:
            return
        with self._lock:
            if task in self._failed:
                return
            self._failed.add(task)
        if entity is not None and entity._executor_event:
            # What came could not be taken, and rclpy left the callback group occupied.
            entity._executor_event = False
            entity.callback_group.ending_execution(entity)
        self._on_error(error)


class DrainingExecutor(StoppableExecutor):
    """Runs callbacks in threads of its own, and waits for them when it is shut down."""

    def __init__(self, threads: int, on_error: ErrorHandler) -> None:
        super().__init__(on_error)
        self._pool = ThreadPoolExecutor(threads, thread_name_prefix='callback')

    def _start(self, task: Task, entity: Any) -> None:
        self._pool.submit(self._run, task, entity)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Begin no callback any more, and wait for all that have begun, without a limit."""
        self._pool.shutdown()
        return bool(super().shutdown(timeout_sec))
