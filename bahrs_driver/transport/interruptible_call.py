# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Call a function that may block, in a thread, and wait for it until interrupted."""

from collections.abc import Callable
import select
import threading
from typing import Generic, Protocol, TypeVar

from bahrs_driver.transport.waker import Waker


class Closable(Protocol):
    """A result that must be closed if wait() was interrupted before."""

    def close(self) -> None:
        """Close it."""


Result = TypeVar('Result', bound=Closable)


class InterruptibleCall(Generic[Result]):
    """
    One call of a function that opens something.

    Name resolution and the negotiation of pyserial cannot be interrupted themselves.
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
        """Return the result of the function, or raise its exception; None if woken."""
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
