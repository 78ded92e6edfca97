# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A reliable subscriber that counts the samples of `line_writer` by their numbers.

It prints a line of JSON with the counts at each report of the driver: its own, and those of the
diagnostics.
"""

import json
import struct
import time

from diagnostic_msgs.msg import DiagnosticArray
from line_writer import number_of
from rclpy.node import Node
from sensor_msgs.msg import Imu
import subscriber

DEPTH = 50_000              # messages; another queue should overflow first
FORCE = struct.Struct('<2d')
FORCE_FROM_END = 8 * (3 + 9)    # force and its covariance end a serialized Imu message


class Counter:
    """Counts samples, and the gaps in their numbers."""

    def __init__(self) -> None:
        self.received = self.lost = 0
        self.next = 0
        self.longest = 0.0          # s without a sample
        self._latest: float | None = None

    def add(self, data: bytes) -> None:
        """Count a serialized Imu message."""
        number = number_of(*FORCE.unpack_from(data, len(data) - FORCE_FROM_END))
        self.received += 1
        self.lost += number - self.next
        self.next = number + 1
        now = time.monotonic()
        if self._latest is not None:
            self.longest = max(self.longest, now - self._latest)
        self._latest = now


def report(counter: Counter, array: DiagnosticArray) -> None:
    """Print the counts."""
    values = {f'{status.name.split(": ")[-1]} {pair.key}': pair.value
              for status in array.status for pair in status.values}
    messages = {status.name.split(': ')[-1]: status.message for status in array.status}
    print(json.dumps({'received': counter.received, 'lost': counter.lost, 'next': counter.next,
                      'longest_ms': round(1e3 * counter.longest), 'diagnostics': values,
                      'messages': messages}),
          flush=True)


def subscribe(node: Node) -> None:
    """Subscribe to the samples and the diagnostics."""
    counter = Counter()
    node.create_subscription(Imu, 'imu/data_raw', counter.add, DEPTH, raw=True)
    node.create_subscription(DiagnosticArray, '/diagnostics',
                             lambda array: report(counter, array), 10)


if __name__ == '__main__':
    subscriber.run('numbered', subscribe)
