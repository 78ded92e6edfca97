# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The path of bytes through the live node, without a ROS graph.

The golden tests use internals of the driver only here. If the reader is replaced, adapt this
module; the hashes must not change.
"""

from collections.abc import Iterator

from bahrs_driver.clock import Instant
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import LinkError
from bahrs_driver.pipeline import Notice
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.ros_layout.layouts import serialize
from bahrs_driver.transport.channel import Reading
from bahrs_driver.transport.port_events import (
    BytesRead, PortOpened, PortUnavailable, PortUsable, StreamEnded,
)
from bahrs_driver.transport.port_reader import PortReader
from golden_inputs import BYTE_NS, Input, Read, SECOND
from support.polled import make_titan, PolledDevice
from support.settings_examples import parts_of, settings_of

EVENTS = 'events'       # name under which notices and failures stand beside the topics


def node_path(source: Input, changes: dict[str, object]) -> list[tuple[str, bytes]]:
    """Return topic and serialized message of all that the node publishes for an input."""
    spec = DEVICES[source.sensor]
    sensor = spec.parts(settings_of(spec.name, **changes).for_recording())
    node = _Node(sensor, _ScriptedLink(source.openings))
    node.run()
    return node.published


def polled_path(changes: dict[str, object]) -> list[tuple[str, bytes]]:
    """Return what the node publishes for a Titan-M that it polls, in simulated time."""
    polled = PolledDevice(make_titan(late_share=0.01, first_fix=2.0),
                          faults={'bit_flip': 0.0003}, mode=0.002)
    polled.run(10.0)
    sensor = parts_of('titan_m', **changes)
    return [(topic, serialize(message)) for _, item in polled.received
            for topic, message in sensor.converter.convert(item.message, item.stamp_ns)]


class _ScriptedLink:
    """A link that opens as often as there are openings, then ends the reader."""

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

    def cancel(self) -> None:
        """Do nothing: nothing waits."""

    def close(self) -> None:
        """Do nothing."""


class _Node:
    """Does with the events of the port what DriverNode does, at the time of the read."""

    def __init__(self, sensor, link: _ScriptedLink) -> None:
        self._sensor = sensor
        self._reader = PortReader(link, sensor.pipeline(), FaultLog(self.note, lambda _: None))
        self._now = Instant(0, 0)
        self.published: list[tuple[str, bytes]] = []

    def note(self, text: str) -> None:
        """Keep a sentence for the log."""
        self.published.append((EVENTS, text.encode()))

    def run(self) -> None:
        """Handle all events."""
        handlers = {PortOpened: self._opened, PortUsable: lambda _: self.note('usable'),
                    PortUnavailable: self._failed, BytesRead: self._read,
                    StreamEnded: self._decoded}
        for event in self._reader.events():
            handlers[type(event)](event)

    def _opened(self, _) -> None:
        """Begin a stream."""
        self._sensor.health.restart()

    def _failed(self, event: PortUnavailable) -> None:
        """Note it, publish the end of the stream, and stop at the end of the script."""
        self.note(f'{event.reason} {event.reported}')
        if event.reason == 'end of the script':
            self._reader.stop()
        self._publish(self._sensor.converter.end_stream(self._now.ros_ns))

    def _read(self, event: BytesRead) -> None:
        """Publish the loss of a stale stream."""
        self._now = event.reading.now
        if self._sensor.health.stale(self._now.raw_ns / SECOND):
            self._publish(self._sensor.converter.report_silence(self._now.ros_ns))
        if event.events is not None:
            self._decoded(event)

    def _decoded(self, event: BytesRead | StreamEnded) -> None:
        """Publish what the messages of one read become."""
        for item in event.events:
            if isinstance(item, Notice):
                self.note(item.text)
                continue
            message, _, stamp_ns = item
            self._publish(self._sensor.converter.convert(message, stamp_ns))
            self._sensor.health.observe(message, self._now.raw_ns / SECOND)
        for sentence in self._sensor.take_notices():
            self.note(sentence)

    def _publish(self, outgoing) -> None:
        self.published += [(topic, serialize(message)) for topic, message in outgoing]
