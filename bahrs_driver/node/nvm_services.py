# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The services that read the non-volatile memory: ~/nvm/read_page, ~/nvm/dump, ~/nvm/cancel.

They are std_srvs/Trigger and respond with JSON. A session takes seconds, so each request runs in a
thread, and its callback is a coroutine that waits for the result: the executor runs other
callbacks meanwhile. The parameters nvm.* are read at each request.
"""

from collections.abc import Callable, Coroutine, Sequence
from concurrent import futures
import hashlib
import json

from bahrs_driver.convert import nvm_page
from bahrs_driver.devices.nvm_reader import NvmReader
from bahrs_driver.devices.nvm_settings import NvmSettings
from bahrs_driver.errors import NvmError, WriteError
from bahrs_driver.node.nvm_dump import dump_file
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.ros_layout.message_objects import to_message
from bahrs_driver.settings.node_settings import read_group
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.task import Future
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger

THREADS = 3                 # a session, a request that it refuses, and one that cancels it

Content = dict[str, str | int | bool]
Callback = Callable[[Trigger.Request, Trigger.Response],
                    Coroutine[object, object, Trigger.Response]]


class NvmServices:
    """Serves requests for pages, and publishes every page that was read."""

    def __init__(self, node: Node, reader: NvmReader, page_count: int, faults: FaultLog) -> None:
        """Create the services and the topic `nvm/page` on a node that has the nvm parameters."""
        self._node = node
        self._reader = reader
        self._page_count = page_count
        self._faults = faults
        self._pages = node.create_publisher(
            UInt8MultiArray, nvm_page.TOPIC, page_count,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._pool = futures.ThreadPoolExecutor(THREADS, thread_name_prefix='nvm')
        self._under_way: set[futures.Future[None]] = set()
        group = ReentrantCallbackGroup()
        for name, action in (('read_page', self._read_page), ('dump', self._dump),
                             ('cancel', self._cancel)):
            node.create_service(Trigger, f'~/nvm/{name}', self._callback(action),
                                callback_group=group)

    def wait(self) -> None:
        """Wait until no request is under way. Call NvmReader.end() first."""
        futures.wait(list(self._under_way))

    def _callback(self, action: Callable[[], Content]) -> Callback:
        async def callback(_request: Trigger.Request,
                           response: Trigger.Response) -> Trigger.Response:
            content = await self._run_in_thread(action)
            response.success = 'error' not in content
            response.message = json.dumps(content)
            return response
        return callback

    def _run_in_thread(self, action: Callable[[], Content]) -> Future:
        """Run an action in a thread; return a future with its content, or with its error."""
        result = Future()

        def run() -> None:
            try:
                content = action()
            except (NvmError, WriteError) as error:
                content = {'error': str(error)}
            except Exception as error:
                self._faults.report('an NVM service', error)
                content = {'error': f'the request failed: {self._faults.last}'}
            result.set_result(content)
            if self._node.executor:
                self._node.executor.wake()

        request = self._pool.submit(run)
        self._under_way.add(request)
        request.add_done_callback(self._under_way.discard)
        return result

    def _read_page(self) -> Content:
        page = self._settings().page
        try:
            return {'page': page, 'data': self._read([page]).hex()}
        except NvmError as error:
            return {'error': str(error), 'page': page}

    def _dump(self) -> Content:
        settings = self._settings()
        # Open the file first: if that fails, the stream need not be interrupted.
        with dump_file(settings.directory, settings.dump_path) as (path, file):
            image = self._read(range(self._page_count))
            file.write(image)
            file.commit()
        return {'path': path, 'bytes': len(image), 'sha256': hashlib.sha256(image).hexdigest()}

    def _cancel(self) -> Content:
        if self._reader.cancel():
            return {'cancelled': True}
        return {'error': 'no NVM request is under way'}

    def _read(self, numbers: Sequence[int]) -> bytes:
        pages = self._reader.read(numbers, self._settings(), self._publish)
        return b''.join(pages[number] for number in numbers)

    def _publish(self, number: int, page: bytes) -> None:
        self._pages.publish(to_message(nvm_page.message(number, page)))

    def _settings(self) -> NvmSettings:
        return read_group(self._node, NvmSettings, 'nvm.')
