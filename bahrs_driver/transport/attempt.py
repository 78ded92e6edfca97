# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Something that takes its time in a thread of its own, so that waiting for it can be ended."""

from collections.abc import Callable
import select
import threading
from typing import Generic, Protocol, TypeVar

from bahrs_driver.transport.waker import Waker


class Closable(Protocol):
    """What has to be closed if the wait for it was given up."""

    def close(self) -> None:
        """Close it."""


Result = TypeVar('Result', bound=Closable)


class Attempt(Generic[Result]):
    """
    One call of a function that opens something.

    Names are looked up, and pyserial negotiates, with nothing that could wake them.
    """

    def __init__(self, function: Callable[[], Result]) -> None:
        self._function = function
        self._done = Waker()
        self._lock = threading.Lock()
        self._abandoned = False
        self._result: Result | None = None
        self._error: Exception | None = None
        threading.Thread(target=self._run, name='connecting', daemon=True).start()

    def wait(self, waker: Waker) -> Result | None:
        """Return what the function returned, or raise what it raised; None if woken."""
        poll = select.poll()
        for each in (self._done, waker):
            poll.register(each.fileno(), select.POLLIN)
        poll.poll()
        with self._lock:
            if self._error is not None:
                raise self._error
            self._abandoned = self._result is None
            return self._result

    def _run(self) -> None:
        try:
            result = self._function()
        except Exception as error:
            self._error = error
        else:
            with self._lock:
                if not self._abandoned:
                    self._result = result
            if self._abandoned:
                result.close()
        self._done.wake()
