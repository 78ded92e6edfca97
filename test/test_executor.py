# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The executor: it waits for what it began, and hides nothing."""

import contextlib
import threading
import time

from bahrs_driver.executor import PatientExecutor
from processes import PATIENCE
import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup


@contextlib.contextmanager
def ticking(callback, threads=2):
    """Give an executor that calls something whenever it has a thread for it."""
    rclpy.init()
    node = rclpy.create_node('ticking')
    node.create_timer(0.001, callback, callback_group=ReentrantCallbackGroup())
    executor = PatientExecutor(threads)
    executor.add_node(node)
    try:
        yield executor
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown()


def test_it_ends_when_all_has_ended(capfd):
    """Nobody is left at work on what is gone, or has to say so."""
    begun, release, ended = threading.Semaphore(0), threading.Event(), []

    def callback():
        begun.release()
        assert release.wait(PATIENCE)
        ended.append(True)

    with ticking(callback) as executor:
        executor.spin_once()
        executor.spin_once()
        assert begun.acquire(timeout=PATIENCE) and begun.acquire(timeout=PATIENCE)
        threading.Timer(0.1, release.set).start()
        assert executor.shutdown()
        assert len(ended) == 2
    assert capfd.readouterr().err == ''


def test_what_went_wrong_is_raised():
    """Where it is turned."""
    def callback():
        raise LookupError('wrong')

    with ticking(callback) as executor, pytest.raises(LookupError, match='wrong'):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            executor.spin_once()


def test_nothing_is_due():
    """It waits as long as it may."""
    with ticking(lambda: None) as executor:
        executor.get_nodes()[0].destroy_timer(next(executor.get_nodes()[0].timers))
        executor.spin_once(0.01)
