# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The path of bytes through the live node, without a ROS graph.

The golden tests use internals of the driver only here. If the receiver is replaced, adapt this
module; the hashes must not change.
"""

from collections.abc import Iterator

from bahrs_driver.bag.serialization import serialized
from bahrs_driver.clock import Instant
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import LinkError
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.transport.link import Reading
from bahrs_driver.transport.receiver import Receiver
from golden_inputs import BYTE_NS, Input, Read, SECOND
from support.polled import make_titan, PolledDevice
from support.settings_examples import parts_of, settings_of

EVENTS = 'events'       # name under which notices and failures stand beside the topics


def node_path(source: Input, changes: dict[str, object]) -> list[tuple[str, bytes]]:
    """Return topic and serialised message of all that the node publishes for an input."""
    spec = DEVICES[source.sensor]
    sensor = spec.parts(settings_of(spec.name, **changes).for_recording())
    node = _Node(sensor)
    node.receiver = Receiver(_ScriptedLink(source.openings), sensor.framer, sensor.codec,
                             sensor.clock, node, FaultLog(node.note, lambda _: None))
    node.receiver.run()
    return node.published


def polled_path(changes: dict[str, object]) -> list[tuple[str, bytes]]:
    """Return what the node publishes for a Titan-M that it polls, in simulated time."""
    polled = PolledDevice(make_titan(late_share=0.01, first_fix=2.0),
                          faults={'bit_flip': 0.0003}, mode=0.002)
    polled.run(10.0)
    sensor = parts_of('titan_m', **changes)
    return [(topic, serialized(message)) for _, item in polled.received
            for topic, message in sensor.converter.convert(item.message, item.stamp_ns)]


class _ScriptedLink:
    """A link that opens as often as there are openings, then ends the receiver."""

    name = 'port'
    byte_time_ns = BYTE_NS

    def __init__(self, openings: list[list[Read]]) -> None:
        self._openings = iter(openings)
        self._reads: Iterator[Read] = iter(())

    def connect(self) -> None:
        """Go to the next opening."""
        try:
            self._reads = iter(next(self._openings))
        except StopIteration:
            raise LinkError('end of the script') from None

    def read(self) -> Reading:
        """Return the next read; LinkError at the end of the opening."""
        for data, raw_ns, ros_ns in self._reads:
            return Reading(data, Instant(raw_ns, ros_ns))
        raise LinkError('port is gone', absent=True)

    def cancel_read(self) -> None:
        """Do nothing: nothing waits."""

    def close(self) -> None:
        """Do nothing."""


class _Node:
    """A listener that does what DriverNode does, at the time of the read."""

    receiver: Receiver

    def __init__(self, sensor) -> None:
        self._sensor = sensor
        self._now = Instant(0, 0)
        self.published: list[tuple[str, bytes]] = []

    def note(self, text: str) -> None:
        """Keep a sentence for the log."""
        self.published.append((EVENTS, text.encode()))

    def link_opened(self) -> None:
        """Begin a stream."""
        self._sensor.health.restart()

    def link_usable(self) -> None:
        """Note it."""
        self.note('usable')

    def link_failed(self, reason: str, known: bool) -> None:
        """Note it, publish the end of the stream, and stop at the end of the script."""
        self.note(f'{reason} {known}')
        if reason == 'end of the script':
            self.receiver.stop()
        self._publish(self._sensor.converter.lost(self._now.ros_ns))

    def bytes_read(self, reading: Reading) -> None:
        """Publish the loss of a stale stream."""
        self._now = reading.now
        if self._sensor.health.stale(self._now.raw_ns / SECOND):
            self._publish(self._sensor.converter.silent(self._now.ros_ns))

    def received(self, batch) -> None:
        """Publish what the messages of one read become."""
        for message, _, stamp_ns in batch:
            self._publish(self._sensor.converter.convert(message, stamp_ns))
            self._sensor.health.observe(message, self._now.raw_ns / SECOND)
        for sentence in self._sensor.take_notices():
            self.note(sentence)

    def time_changed(self, sentence: str) -> None:
        """Note it."""
        self.note(sentence)

    def _publish(self, outgoing) -> None:
        self.published += [(topic, serialized(message)) for topic, message in outgoing]
