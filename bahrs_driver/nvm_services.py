# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The services that read the non-volatile memory: ~/nvm/read_page, ~/nvm/dump, ~/nvm/cancel.

They are std_srvs/Trigger; what they answer is JSON. A session takes seconds, so they stand in
a callback group of their own, each call in a thread of the executor, and nothing else waits.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

from bahrs_driver.convert import nvm_page
from bahrs_driver.nvm_reader import NvmError, NvmReader
from bahrs_driver.protocol.nvm import PAGES
from bahrs_driver.whole_file import check_target, write_whole
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger


class NvmServices:
    """Answers requests for pages, and publishes every page that was read."""

    def __init__(self, node: Node, reader: NvmReader) -> None:
        """Make the services and the topic `nvm/page` on a node that has the nvm parameters."""
        self._node = node
        self._reader = reader
        self._pages = node.create_publisher(UInt8MultiArray, nvm_page.TOPIC, PAGES)
        group = ReentrantCallbackGroup()
        for name, callback in (('read_page', self._read_page), ('dump', self._dump),
                               ('cancel', self._cancel)):
            node.create_service(Trigger, f'~/nvm/{name}', callback, callback_group=group)

    def _read_page(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        page = self._node.get_parameter('nvm.page').value
        try:
            data = self._read([page])
        except NvmError as error:
            return _answer(response, error=str(error), page=page)
        return _answer(response, page=page, data=data.hex())

    def _dump(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        path = Path(self._node.get_parameter('nvm.dump_path').value).expanduser()
        try:
            check_target(path)                  # told before the stream is stopped for it
            image = self._read(range(PAGES))
            write_whole(path, image)
        except (NvmError, ValueError) as error:
            return _answer(response, error=str(error))
        except OSError as error:
            return _answer(response, error=f'cannot write {path}: {error.strerror}')
        return _answer(response, path=str(path), bytes=len(image),
                       sha256=hashlib.sha256(image).hexdigest())

    def _cancel(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self._reader.cancel():
            return _answer(response, cancelled=True)
        return _answer(response, error='no NVM request is under way')

    def _read(self, wanted: Any) -> bytes:
        pages = self._reader.read(wanted)
        for data in pages.values():
            self._pages.publish(nvm_page.message(data))
        return b''.join(pages[number] for number in wanted)


def _answer(response: Trigger.Response, **content: Any) -> Trigger.Response:
    response.success = 'error' not in content
    response.message = json.dumps(content)
    return response
