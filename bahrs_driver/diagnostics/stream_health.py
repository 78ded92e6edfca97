# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The diagnostics of one device and its stream of messages."""

from collections.abc import Sequence

from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.task import DiagnosticTask
from bahrs_driver.protocol.message import Message


class StreamHealth:
    """Watches the messages of a device; the task rates detects a stale stream."""

    def __init__(self, rates: RatesTask, *tasks: DiagnosticTask) -> None:
        self._rates = rates
        self.stale = rates.stale        # whether the stream has stopped, at a monotonic time
        self.tasks: Sequence[DiagnosticTask] = (rates, *tasks)

    def observe(self, message: Message, now: float) -> None:
        """Count a message that arrived at a time of time.monotonic()."""
        self._rates.observe(message, now)

    def restart(self) -> None:
        """Begin a new stream."""
        self._rates.restart()

    @property
    def lost(self) -> int:
        """Messages lost since the start."""
        return sum(self._rates.lost.values())

    def device_id(self) -> str:
        """Return the identification of the device; empty if it has sent none."""
        return ''
