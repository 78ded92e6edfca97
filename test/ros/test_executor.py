# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The executor survives failing callbacks, stops when asked, and completes coroutines."""

import contextlib
import itertools
import threading

from bahrs_driver.ros.executor import StoppableExecutor
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.task import Future
from support.waiting import PATIENCE, wait_for


@contextlib.contextmanager
def spinning(callback, on_error=pytest.fail):
    """Spin an executor in a thread, with a timer that is due every millisecond."""
    rclpy.init()
    node = rclpy.create_node('ticking')
    node.create_timer(0.001, callback, callback_group=ReentrantCallbackGroup(),
                      clock=Clock(clock_type=ClockType.STEADY_TIME))
    executor = StoppableExecutor(on_error)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    try:
        yield executor, node
    finally:
        executor.stop()
        thread.join(PATIENCE)
        alive = thread.is_alive()
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown()
        assert not alive


def test_stop_completes_coroutines(capfd):
    """A coroutine whose future is done when stop() is called continues first."""
    begun, result, ended = threading.Event(), Future(), []

    async def wait():
        begun.set()
        ended.append(await result)

    with spinning(lambda: None) as (executor, _):
        executor.create_task(wait)
        assert begun.wait(PATIENCE)
        result.set_result('done')
        executor.stop()
    assert ended == ['done']
    assert capfd.readouterr().err == ''


def test_a_waiting_coroutine_delays_no_callback():
    """Callbacks of the same group run while a coroutine waits in another one."""
    calls, result = [], Future()

    async def wait():
        await result

    with spinning(lambda: calls.append(True)) as (executor, _):
        task = executor.create_task(wait)
        assert wait_for(lambda: len(calls) > 10)
        assert not task.done()
        result.set_result(None)
        assert wait_for(task.done)


@settings(max_examples=8, deadline=None, derandomize=True,
          suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(error=st.sampled_from([LookupError('x'), TypeError(), SystemExit(3), KeyboardInterrupt(),
                              UnicodeDecodeError('utf-8', b'\xff', 0, 1, 'bad'), MemoryError()]))
def test_a_callback_that_raises(error):
    """Its exception is reported, and it is called again."""
    numbers, calls, errors = itertools.count(1), [], []

    def callback():
        number = next(numbers)
        calls.append(number)
        if number <= 2:
            raise error

    with spinning(callback, errors.append):
        assert wait_for(lambda: len(calls) > 5)
    assert [type(each) for each in errors] == [type(error)] * 2


def test_a_message_that_cannot_be_taken(monkeypatch):
    """Its callback group is free afterwards, so timers of the group run on."""
    calls, errors = [], []
    with spinning(lambda: None, errors.append) as (executor, node):
        take, broken = executor._take_timer, threading.Event()
        slow = node.create_timer(3600.0, lambda: calls.append(True))

        def fail(timer):
            if timer is slow and not broken.is_set():
                broken.set()
                raise UnicodeDecodeError('utf-8', b'\xff', 0, 1, 'bad')
            return take(timer)

        monkeypatch.setattr(executor, '_take_timer', fail)
        slow.timer_period_ns = 2_000_000
        slow.reset()
        executor.wake()
        assert wait_for(lambda: len(calls) > 2)
    assert [type(each) for each in errors] == [UnicodeDecodeError]


def test_stop_wakes_an_executor_that_waits_for_nothing():
    """Without a timer, spinning would wait forever."""
    with spinning(lambda: None) as (executor, node):
        node.destroy_timer(next(node.timers))


def test_spin_ends_with_its_context():
    """Another part of the process may shut the context down."""
    context = Context()
    rclpy.init(context=context)
    executor = StoppableExecutor(pytest.fail, context)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    rclpy.shutdown(context=context)
    thread.join(PATIENCE)
    assert not thread.is_alive()
    executor.shutdown()


def test_waiting_that_fails_is_tried_again(monkeypatch):
    """The cause is reported each time, without a busy loop."""
    calls, errors = [], []
    with spinning(lambda: calls.append(True), errors.append) as (executor, _):
        wait = executor.wait_for_ready_callbacks

        def fail(*args):
            if len(errors) < 3:
                raise RuntimeError('no memory')
            return wait(*args)

        monkeypatch.setattr(executor, 'wait_for_ready_callbacks', fail)
        assert wait_for(lambda: len(errors) == 3)
        seen = len(calls)
        assert wait_for(lambda: len(calls) > seen)


def test_a_timeout():
    """spin_once() returns after its timeout."""
    with spinning(lambda: None) as (executor, node):
        executor.stop()
    rclpy.init()
    executor = StoppableExecutor(pytest.fail)
    executor.spin_once(0.01)
    executor.shutdown()
    rclpy.shutdown()
