# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The services that read the non-volatile memory: ~/nvm/read_page, ~/nvm/dump, ~/nvm/cancel.

They are std_srvs/Trigger, and answer JSON. A session takes seconds, so they have a callback group
of their own, each call runs in a thread of the executor, and nothing else waits. The parameters
nvm.* are read at each call.
"""

from collections.abc import Callable, Iterable
import hashlib
import json
from typing import Any

from bahrs_driver.convert.bahrs import nvm_page
from bahrs_driver.errors import NvmError, WriteError
from bahrs_driver.node.nvm_dump import dump_file
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.protocol.bahrs.nvm_session import PAGES
from bahrs_driver.transport.nvm_reader import NvmReader, SessionOptions
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger

Answer = dict[str, Any]


class NvmServices:
    """Answers requests for pages, and publishes every page that was read."""

    def __init__(self, node: Node, reader: NvmReader, faults: FaultLog) -> None:
        self._node = node
        self._reader = reader
        self._faults = faults
        self._pages = node.create_publisher(
            UInt8MultiArray, nvm_page.TOPIC, PAGES,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        group = ReentrantCallbackGroup()
        for name, action in (('read_page', self._read_page), ('dump', self._dump),
                             ('cancel', self._cancel)):
            node.create_service(Trigger, f'~/nvm/{name}', self._answering(action),
                                callback_group=group)

    def _answering(self, action: Callable[[], Answer]
                   ) -> Callable[[Trigger.Request, Trigger.Response], Trigger.Response]:
        """Return the callback of a service that answers whatever the action raises."""
        def callback(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            try:
                content = action()
            except (NvmError, WriteError) as error:
                content = {'error': str(error)}
            except Exception as error:
                self._faults.report('an NVM service', error)
                content = {'error': f'the request failed: {self._faults.last}'}
            response.success = 'error' not in content
            response.message = json.dumps(content)
            return response
        return callback

    def _read_page(self) -> Answer:
        page = self._value('nvm.page')
        try:
            return {'page': page, 'data': self._read([page]).hex()}
        except NvmError as error:
            return {'error': str(error), 'page': page}

    def _dump(self) -> Answer:
        # The file first: what is wrong with it is found out before the stream is stopped.
        with dump_file(self._value('nvm.directory'), self._value('nvm.dump_path')) as (path, file):
            image = self._read(range(PAGES))
            file.write(image)
            file.commit()
        return {'path': path, 'bytes': len(image), 'sha256': hashlib.sha256(image).hexdigest()}

    def _cancel(self) -> Answer:
        if self._reader.cancel():
            return {'cancelled': True}
        return {'error': 'no NVM request is under way'}

    def _read(self, wanted: Iterable[int]) -> bytes:
        wanted = list(wanted)
        options = SessionOptions(self._value('nvm.enter_timeout'),
                                 self._value('nvm.service_frames'))
        pages = self._reader.read(wanted, options, self._publish)
        return b''.join(pages[number] for number in wanted)

    def _publish(self, number: int, page: bytes) -> None:
        self._pages.publish(nvm_page.message(number, page))

    def _value(self, name: str) -> Any:
        return self._node.get_parameter(name).value
