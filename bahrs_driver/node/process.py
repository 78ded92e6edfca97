# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run the node in a process: start its threads, restart them after faults, and end them."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
import gc
import sys
import time

from bahrs_driver.errors import ParameterError, RosStartError
from bahrs_driver.node.driver_node import DriverNode
from bahrs_driver.process.exit_timer import exit_after
from bahrs_driver.process.printable import printable
from bahrs_driver.process.shutdown_event import end_process, EXIT_TIME, ShutdownEvent
from bahrs_driver.ros.executor import StoppableExecutor
from bahrs_driver.ros.start import init_ros
from bahrs_driver.ros.start_errors import start_errors
from bahrs_driver.settings.command_line import RosArguments, split_arguments
from bahrs_driver.settings.parameter_files import is_pipe
import rclpy
from rclpy.utilities import remove_ros_args

RESTART_PERIOD = 1.0        # s before a failed thread runs again
SET_BACK = 0.1              # s; after the host clock is set back by more, the exit can hang


def run(shutdown: ShutdownEvent) -> int:
    """Run the node until the shutdown event is set; return 0, or 1 if it cannot start."""
    if shutdown.is_set():       # while this module was imported
        return 0
    offset = _host_clock_offset()
    try:
        with start_errors(sys.argv):
            node = _start()
        executor = _run_node(node, shutdown)
        if _host_clock_offset() < offset - SET_BACK:
            end_process(0)      # destroying the node hangs then, and crashed once in 200 times
        executor.shutdown()
        node.destroy_node()  # type: ignore[no-untyped-call]
    except RosStartError as error:
        print('bahrs_driver:', error, file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


def _start() -> DriverNode:
    _check_arguments(sys.argv)
    no_log_files = init_ros(sys.argv)
    node = DriverNode()
    if no_log_files:
        node.get_logger().warning(  # type: ignore[no-untyped-call]
            f'logs are not written to files: {printable(no_log_files)}; set ROS_LOG_DIR')
    return node


def _run_node(node: DriverNode, shutdown: ShutdownEvent) -> StoppableExecutor:
    """
    Run the node's threads and the executor until the shutdown event is set.

    Return the executor, to be shut down after the port is closed and spinning has ended.
    """
    executor = StoppableExecutor(lambda error: node.faults.report('a request or timer', error))
    executor.add_node(node)
    _shorten_garbage_collections()
    with ThreadPoolExecutor(max_workers=len(node.threads) + 1) as pool:
        for name, run_thread in node.threads.items():
            pool.submit(_keep_running, name, run_thread, node, shutdown)
        pool.submit(executor.spin)
        shutdown.wait()
        exit_after(EXIT_TIME)
        node.leave_device()
        node.stop()
        executor.stop()
    return executor


def _shorten_garbage_collections() -> None:
    """
    Exclude what exists now, such as all modules, from garbage collection.

    A full collection would stop the reading thread for 13 ms, on a busy host for longer.
    """
    gc.collect()
    gc.freeze()


def _keep_running(name: str, run_thread: Callable[[], None], node: DriverNode,
                  shutdown: ShutdownEvent) -> None:
    """Run a thread's function until it returns; run it again after an exception."""
    while True:
        try:
            return run_thread()
        except Exception as error:
            node.faults.report(name, error)
        if shutdown.wait(RESTART_PERIOD):
            return


def _host_clock_offset() -> float:
    """Return the host clock minus steady time in seconds; only setting the clock changes it."""
    return time.time() - time.monotonic()


def _check_arguments(words: list[str]) -> None:
    """Raise the errors of rcl about its arguments without its log lines."""
    own = split_arguments(words)[0][1:]
    if own:
        raise ParameterError(f'{printable(repr(own[0]))} is not understood: parameters are given '
                             'as --ros-args -p port:=/dev/ttyUSB0')
    if not any(map(is_pipe, RosArguments.from_words(words).files)):
        remove_ros_args(words)          # reads parameter files; a pipe can be read only once
