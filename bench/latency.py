# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure the latency from the last byte of a frame to the callback of a subscriber.

A device writes its frames to a pseudo-terminal at full rates; force x holds the number of the
sample. As the floor, a process publishes messages that hold the time at which they were published.
The subscriber is a process of its own.
"""

import argparse
import statistics
import time

from bahrs_driver.protocol.bahrs.messages import FORCE, Inertial
from bahrs_driver.virtual_serial.pty_port import PtyPort
from node_cpu import script
from support.devices import Device
from support.domain import use_own_domain
from support.processes import driver
from support.waiting import wait_for

SETTLING = 3.0          # s, not measured
COUNTS = 1 << 15        # values of force x, positive ones only


class TimedDevice(Device):
    """Writes frames, and keeps when it wrote those of samples."""

    def __init__(self, port: PtyPort) -> None:
        super().__init__(port, change=self._record)
        self.written: list[float] = []

    def _record(self, data: bytes, _index: int) -> bytes:
        if data[4] == Inertial.TYPE:
            self.written.append(time.monotonic())
        return data


def received(text: str) -> list[tuple[float, float]]:
    """Return what a subscriber has printed."""
    pairs = [line.split() for line in text.splitlines() if line[:1].isdigit()]
    return [(float(value), float(at)) for value, at in pairs]


def measure_bare(duration: float) -> list[float]:
    """Return the latencies of a bare publisher, in ms."""
    with script('latency_subscriber') as subscriber:
        assert wait_for(lambda: 'ready' in subscriber.text)
        with script('bare_publisher'):
            time.sleep(SETTLING + duration)
        subscriber.end()
        pairs = received(subscriber.text)
    return [1e3 * (at - sent) for sent, at in pairs if sent > pairs[0][0] + SETTLING]


def measure_node(duration: float) -> list[float]:
    """Return the latencies of the node, in ms."""
    assert 200 * (SETTLING + duration) < COUNTS
    with script('latency_subscriber') as subscriber:
        assert wait_for(lambda: 'ready' in subscriber.text)
        with PtyPort() as port, driver(port.path) as process:
            assert wait_for(lambda: 'is open' in process.text), process.text
            with TimedDevice(port) as device:
                time.sleep(SETTLING + duration)
        subscriber.end()
        pairs = received(subscriber.text)
    start = device.written[0] + SETTLING
    sent = [(device.written[round(value / FORCE)], at) for value, at in pairs]
    return [1e3 * (at - written) for written, at in sent if written > start]


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--duration', type=float, default=30.0, help='seconds for each row')
    options = parser.parse_args()
    use_own_domain()
    for name, measure in (('bare publisher', measure_bare), ('node', measure_node)):
        latencies = sorted(measure(options.duration))
        p50, p99 = (statistics.quantiles(latencies, n=100)[index] for index in (49, 98))
        print(f'{name:<16}{len(latencies):7,} messages  p50 {p50:.2f} ms  p99 {p99:.2f} ms  '
              f'max {latencies[-1]:.1f} ms')


if __name__ == '__main__':
    main()
