# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Wait for subscribers before the first data.

Discovery connects a subscriber, even one that was started first, up to some seconds after the
publisher is created. Messages that are published meanwhile are lost. A node that opens its port
only when all its topics have a subscriber loses none.
"""

from collections.abc import Callable, Mapping
import threading
from typing import Protocol

from rclpy.event_handler import PublisherEventCallbacks

Write = Callable[[str], object]


class Counting(Protocol):
    """A publisher that counts its subscribers."""

    def get_subscription_count(self) -> int:
        """Return the number of matched subscribers."""


class SubscriberGate:
    """Blocks a thread until publishers have subscribers, for a limited time."""

    def __init__(self, limit: float) -> None:
        """Wait for limit seconds at most; not at all if it is 0."""
        self._limit = limit
        self._changed = threading.Condition()
        self._open = not limit

    def callbacks(self) -> PublisherEventCallbacks | None:
        """Return event callbacks for the publishers that wait() is called with."""
        return None if self._open else PublisherEventCallbacks(matched=lambda _: self._notify())

    def open(self) -> None:  # noqa: A003
        """End the waiting."""
        with self._changed:
            self._open = True
            self._changed.notify_all()

    def wait(self, publishers: Mapping[str, Counting], write_info: Write,
             write_warning: Write) -> None:
        """Wait until each publisher has a subscriber; log the topics without one at the limit."""
        if self._open:
            return
        write_info(f'the port is opened when all topics have a subscriber, after '
                   f'{self._limit:g} s at the latest (startup.wait_for_subscribers)')

        def missing() -> list[str]:
            return [topic for topic, publisher in publishers.items()
                    if not publisher.get_subscription_count()]

        with self._changed:
            self._changed.wait_for(lambda: self._open or not missing(), self._limit)
            stopped, self._open = self._open, True
        if not stopped and (topics := missing()):
            write_warning(f'no subscriber within {self._limit:g} s of {", ".join(topics)}: the '
                          'port is opened without them')

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()
