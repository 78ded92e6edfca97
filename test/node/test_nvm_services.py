# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the NVM services without a device: every request is answered."""

import json

from bahrs_driver.errors import NvmError
from bahrs_driver.node.nvm_services import NvmServices
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.ros.executor import StoppableExecutor
import pytest
import rclpy
from rclpy.context import Context
from std_srvs.srv import Trigger
from support.waiting import PATIENCE

PARAMETERS = {'nvm.page': 3, 'nvm.directory': '/proc/nowhere', 'nvm.dump_path': 'x',
              'nvm.enter_timeout': 2.5, 'nvm.service_frames': 'mpeg2'}


class Reader:
    """Reads pages from nowhere, or raises."""

    def __init__(self):
        """Have no error yet."""
        self.error, self.asked = None, []

    def read(self, pages, settings, on_page):
        """Return pages of zeros, and report each."""
        self.asked.append((list(pages), (settings.enter_timeout, settings.service_frames)))
        for page in pages:
            on_page(page, bytes(32))
        if self.error:
            raise self.error
        return {page: bytes(32) for page in pages}


@pytest.fixture
def ask():
    """Return a function that calls a service; it has the reader and the node as attributes."""
    context, callbacks, published = Context(), {}, []
    rclpy.init(context=context)
    node = rclpy.create_node('services', context=context)
    for name, value in PARAMETERS.items():
        node.declare_parameter(name, value)
    node.create_service = lambda kind, name, callback, **_: callbacks.update({name: callback})
    reader = Reader()
    services = NvmServices(node, reader, 250, FaultLog(str, str))
    services._pages.publish = lambda message: published.append(message.layout.dim[0].label)

    executor = StoppableExecutor(pytest.fail, context)
    executor.add_node(node)

    def call(name):
        task = executor.create_task(
            callbacks[f'~/nvm/{name}'], Trigger.Request(), Trigger.Response())
        while not task.done():
            executor.spin_once(PATIENCE)
        return task.result().success, json.loads(task.result().message)
    call.reader, call.node, call.published = reader, node, published
    yield call
    services.wait()
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_parameters_of_each_call(ask):
    """Values that were set since the last call."""
    assert ask('read_page') == (True, {'page': 3, 'data': '00' * 32})
    ask.node.set_parameters([rclpy.Parameter('nvm.service_frames', value='auto'),
                             rclpy.Parameter('nvm.page', value=4)])
    assert ask('read_page')[0]
    assert ask.reader.asked == [([3], (2.5, 'mpeg2')), ([4], (2.5, 'auto'))]
    assert ask.published == ['page=3', 'page=4']


@pytest.mark.parametrize('error', [
    NvmError('the page never came'), ValueError('NVM pages are 0 to 249'), RuntimeError(),
    OSError(28, 'No space left on device'), KeyError('page')])
def test_every_request_is_answered(ask, tmp_path, error):
    """For any exception; earlier pages were published."""
    ask.reader.error = error
    success, answer = ask('read_page')
    assert not success and answer['error'] and ask.published == ['page=3']
    success, answer = ask('dump')
    assert not success and answer['error'].startswith('parameter nvm.directory: cannot make')
    assert len(ask.reader.asked) == 1, 'the device was asked, though there is no file'
    ask.node.set_parameters([rclpy.Parameter('nvm.directory', value=str(tmp_path))])
    success, answer = ask('dump')
    assert not success and str(error.args[-1] if error.args else 'RuntimeError') in answer['error']
    assert not list(tmp_path.iterdir())
