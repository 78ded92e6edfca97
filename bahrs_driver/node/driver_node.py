# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node: it wires the parts together, and nothing else."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
import sys
from threading import Lock
import time
from typing import Any

from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.convert import raw, ros
from bahrs_driver.devices.registry import DEVICES, parameter_table, recognize
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.link_task import LinkTask
from bahrs_driver.diagnostics.names import node_label
from bahrs_driver.diagnostics.problem_log import ProblemLog
from bahrs_driver.diagnostics.publishing_task import PublishingTask
from bahrs_driver.diagnostics.self_test import answer
from bahrs_driver.diagnostics.sharing_watch import count_trouble
from bahrs_driver.diagnostics.task import DiagnosticTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.diagnostics.updater import Updater
from bahrs_driver.errors import ParameterError
from bahrs_driver.node.latched_publisher import create_latched
from bahrs_driver.node.nvm_services import NvmServices
from bahrs_driver.node.sim_time import keep_host_time
from bahrs_driver.node.subscriber_gate import SubscriberGate
from bahrs_driver.pipeline import DecodingFault, Notice, Pipeline
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.node_settings import NodeSettings
from bahrs_driver.settings.parameter_node import ParameterNode
from bahrs_driver.settings.parameter_requests import ParameterRequests
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_events import (
    BytesRead,
    Decoded,
    PortOpened,
    PortUnavailable,
    PortUsable,
    Silence,
)
from bahrs_driver.transport.port_reader import PortReader
from diagnostic_msgs.msg import DiagnosticArray
from diagnostic_msgs.srv import SelfTest
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import NameValidationException
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.time import Time
from sensor_msgs.msg import TimeReference
from std_msgs.msg import UInt8MultiArray

QUEUE_DEPTH = 100               # half a second of the fastest topic
DIAGNOSTICS_PERIOD = 1.0        # s
WATCH_PERIOD = 0.1              # s, for what changes because nothing comes


class DriverNode(ParameterNode):
    """Publishes the messages of a sensor on a serial port, and diagnostics."""

    def __init__(self) -> None:
        """Read the parameters and make the parts; ParameterError if one is bad."""
        arguments = RosArguments.from_words(sys.argv)
        super().__init__(arguments)
        self._log = self.get_logger()  # type: ignore[no-untyped-call]
        self.faults = FaultLog(self._log.error, self._log.debug)
        given = NodeSettings(self, arguments, parameter_table())
        settings = given.settings
        ParameterRequests(self, given)
        keep_host_time(self)
        self._link = _link(settings)
        self._spec = spec = DEVICES[given.sensor]
        self._parts = parts = spec.parts(settings)
        self._live = live = parts.live(self._link)
        self._pipeline = Pipeline(parts.framer, parts.codec, parts.clock)
        self._reader = PortReader(self._link, self._pipeline, self.faults,
                                  live.requests.lock if live.requests else nullcontext())
        self._handlers: dict[type, Callable[[Any], None]] = {
            PortOpened: self._begin_stream, PortUsable: self._log_open,
            PortUnavailable: self._end_stream, BytesRead: self._publish_bytes,
            Silence: self._check_silence, Decoded: self._publish_events}
        self._time_task = TimeTask(parts.clock, parts.health.stale)
        self._counts = dict.fromkeys(spec.topics(), 0)
        self._link_task = LinkTask(self._link, self._reader.counters, parts.silence_timeout,
                                   parts.silence_hint, lambda: count_trouble(
                                       self._pipeline.counters.framing, parts.health.lost))
        self._updater = self._make_updater(settings)
        self._problems = self._make_problem_log()
        self._gate = SubscriberGate(settings.startup.wait_for_subscribers)
        self._reporting = Lock()        # or an older report could overtake a newer one
        self._latched = {topic: create_latched(self, message_type, topic, self._publisher)
                         for topic, message_type in spec.topics().items()
                         if topic in spec.latched()}
        self._data = {topic: self._latched.get(topic) or self._publisher(message_type, topic)
                      for topic, message_type in spec.topics().items()}
        self._raw = None
        if settings.publish.raw:
            self._raw = self._publisher(UInt8MultiArray, raw.TOPIC)
        self._diagnostics = self._publisher(DiagnosticArray, '/diagnostics')
        if parts.pulse_topic:
            self._listen_for_pulses(parts.pulse_topic)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(DIAGNOSTICS_PERIOD, self._report, clock=steady)
        self.create_timer(WATCH_PERIOD, self._watch, clock=steady)
        self.create_service(SelfTest, '~/self_test', self._self_test)
        self._nvm_services = NvmServices(self, live.nvm, spec.memory.page_count, self.faults) \
            if live.nvm and spec.memory else None
        for sentence in (*given.warnings(), *parts.warnings):
            self._log.warning(sentence)

    @property
    def threads(self) -> Mapping[str, Callable[[], None]]:
        """Functions that each run in a thread until stop() is called, by name."""
        requests = self._live.requests
        return {'the reading thread': self._read,
                **({'the requesting thread': requests.run} if requests else {})}

    def stop(self) -> None:
        """Make the threads end soon."""
        if self._live.requests:
            self._live.requests.stop()
        self._gate.open()
        self._reader.stop()

    def _read(self) -> None:
        raw_data = {raw.TOPIC: self._raw} if self._raw else {}
        self._gate.wait({**self._data, **raw_data}, self._log.info, self._log.warning)
        for event in self._reader.events():
            kind = type(event)
            self.faults.survive(f'handling the event {kind.__name__}', self._handlers[kind], event)

    def leave_device(self) -> None:
        """Leave diagnostics mode if the driver entered it."""
        if self._live.nvm:
            self._live.nvm.end('the driver is ending')
        if self._nvm_services:
            self._nvm_services.wait()

    def _begin_stream(self, _event: PortOpened) -> None:
        self._send_requests()
        self._parts.health.restart()
        self._report_change()

    def _send_requests(self) -> None:
        if self._live.requests:
            self._live.requests.send_due()

    def _log_open(self, _event: PortUsable) -> None:
        self._log.info(f'{self._link.name} is open')
        self._report_change()

    def _end_stream(self, event: PortUnavailable) -> None:
        """Publish that data is lost, and log the reason unless it was logged before."""
        if not event.reported:
            self._log.error(event.reason)
        if self._live.nvm:
            self._live.nvm.lost(event.reason)
        self.faults.survive('publishing that data is lost', lambda: self._publish(
            self._parts.converter.lost(time.time_ns())))
        self._report_change()

    def _publish_bytes(self, event: BytesRead) -> None:
        """Publish the bytes of a read if publish.raw is set, and the loss of a stale stream."""
        if self._raw:
            (data, now), connection = event.reading, event.connection
            metadata = ReadMetadata(self._spec.name, connection.number, connection.byte_time_ns,
                                    now.ros_ns, now.raw_ns)
            self.faults.survive('publishing raw', self._raw.publish,
                                raw.message(data, metadata.to_label()))
        self._check_silence()
        for publisher in self._latched.values():
            publisher.flush()

    def _check_silence(self, _event: Silence | None = None) -> None:
        """Publish that the device is silent, if it is."""
        if self._parts.health.stale(time.monotonic()):
            self._publish(self._parts.converter.silent(time.time_ns()))

    def _publish_events(self, event: Decoded) -> None:
        """Publish the messages of one read; log notices and faults."""
        self._send_requests()           # first, because the line is idle after an answer
        now, survive = time.monotonic(), self.faults.survive
        parts, nvm = self._parts, self._live.nvm
        for item in event.events:
            if isinstance(item, Notice):
                self._log.warning(item.text)
                self._time_task.notice(item.text, now)
            elif isinstance(item, DecodingFault):
                self.faults.report('decoding a frame', item.error)
            else:
                message, frame, stamp_ns = item
                survive(f'publishing {message.NAME}', self._publish_message, message, stamp_ns)
                survive('watching the data', parts.health.observe, message, now)
                if nvm:
                    survive('reading the memory', nvm.receive, message, frame)
        survive('watching the clock', self._time_task.update, now)
        for sentence in parts.take_notices():
            self._log.warning(sentence)
        self._report_change()

    def _report_change(self) -> None:
        """Publish the diagnostics if they changed; a change that comes too soon waits."""
        with self._reporting:
            if self._updater.change_due():
                self._publish_report()

    def _watch(self) -> None:
        """Report what changes because nothing arrives, and serve subscribers that lag."""
        for publisher in self._latched.values():
            publisher.supervise()
        self._report_change()
        # Why the port is not open was logged when it closed.
        is_open = self._reader.counters.open_since is not None
        self._problems.check(self._updater.summaries() if is_open else {}, time.monotonic())

    def _listen_for_pulses(self, topic: str) -> None:
        try:
            # A reliable subscription would get nothing from a best-effort publisher.
            self.create_subscription(
                TimeReference, topic, self._on_pulse_reference,
                QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())
        except NameValidationException as error:
            raise ParameterError(
                f"parameter time.sync_pulse.reference is {topic!r}: it must be 'ros_clock' "
                'or the name of a topic') from error

    def _on_pulse_reference(self, message: TimeReference) -> None:
        self._parts.clock.pulse_reference(ros.nanoseconds(message.header))

    def _publish_message(self, message: Any, stamp_ns: int) -> None:
        self._publish(self._parts.converter.convert(message, stamp_ns))

    def _publish(self, outgoing: Iterable[tuple[str, Any]]) -> None:
        for topic, message in outgoing:
            self._data[topic].publish(message)
            self._counts[topic] += 1

    def _report(self) -> None:
        self._link_task.check_sharing(time.monotonic())
        with self._reporting:
            if self._updater.report_allowed():
                self._publish_report()

    def _publish_report(self) -> None:
        array = DiagnosticArray(status=self._updater.statuses())
        array.header.stamp = Time(nanoseconds=time.time_ns()).to_msg()
        self._diagnostics.publish(array)

    def _self_test(self, _: SelfTest.Request, response: SelfTest.Response) -> SelfTest.Response:
        return answer(self._updater.summaries(), self._updater.hardware_id,
                      self._parts.health.device_id(), response)

    def _make_updater(self, settings: CommonSettings) -> Updater:
        spec, parts = self._spec, self._parts
        tasks: list[DiagnosticTask] = [
            self._link_task,
            FramingTask(self._pipeline.counters, self._link.baud_rate, spec.name,
                        parts.protocol, recognize, settings.diagnostics.damaged_share),
            self._time_task,
            *parts.health.tasks,
            *self._live.tasks,
            PublishingTask(self._counts, parts.silence_timeout, spec.latched(), self.faults)]
        return Updater(tasks, node_label(self.get_name(), self.get_namespace(),
                                         settings.diagnostics.qualified_name),
                       self._link.name, faults=self.faults)

    def _make_problem_log(self) -> ProblemLog:
        port, logger = self._link.name, self._log
        return ProblemLog({'Link': f'{port} is in order again',
                           'Framing': f'{port}: frames arrive intact'},
                          logger.error, logger.info)

    def _publisher(self, message_type: type, topic: str,
                   profile: QoSProfile | None = None) -> Publisher:
        return self.create_publisher(
            message_type, topic, profile or QoSProfile(depth=QUEUE_DEPTH),
            event_callbacks=self._gate.callbacks(),
            qos_overriding_options=QoSOverridingOptions.with_default_policies())


def _link(settings: CommonSettings) -> Link:
    try:
        return Link(settings.port, settings.baud_rate)
    except ValueError as error:
        raise ParameterError(f'parameter port is {settings.port!r}: {error}') from error
