# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node: it connects the port, the pipeline and the topics of a device."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
import sys
import threading
import time

from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.convert import raw
from bahrs_driver.devices.registry import DEVICES, parameter_table, recognize
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.link_task import LinkTask
from bahrs_driver.diagnostics.names import node_label
from bahrs_driver.diagnostics.problem_log import ProblemLog
from bahrs_driver.diagnostics.publishing_task import PublishingTask
from bahrs_driver.diagnostics.task import DiagnosticTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.diagnostics.updater import Updater
from bahrs_driver.errors import ParameterError
from bahrs_driver.node.diagnostics_publisher import DiagnosticsPublisher, TOPIC
from bahrs_driver.node.nvm_services import NvmServices
from bahrs_driver.node.sim_time import keep_host_time
from bahrs_driver.node.topics import LEAST_QUEUE_DEPTH, Topics
from bahrs_driver.pipeline import DecodingFault, Event, Notice, Stamped
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.ros.header import nanoseconds
from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.node_settings import NodeSettings
from bahrs_driver.settings.parameter_node import ParameterNode
from bahrs_driver.settings.parameter_requests import ParameterRequests
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_events import (
    BytesRead, PortEvent, PortOpened, PortUnavailable, PortUsable, Silence, StreamEnded,
)
from bahrs_driver.transport.port_reader import PortReader
from diagnostic_msgs.msg import DiagnosticArray
from diagnostic_msgs.srv import SelfTest
from rclpy.exceptions import NameValidationException
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import TimeReference

DIAGNOSTICS_PERIOD = 1.0        # s
WATCH_PERIOD = 0.1              # s between checks for changes without data


class DriverNode(ParameterNode):
    """Publishes the messages of a device on a serial port, and diagnostics."""

    def __init__(self) -> None:
        """Declare the parameters and create all parts; ParameterError if one is invalid."""
        arguments = RosArguments.from_words(sys.argv)
        super().__init__(arguments)
        self._log = self.get_logger()  # type: ignore[no-untyped-call]
        self.faults = FaultLog(self._log.error, self._log.debug)
        node_settings = NodeSettings(self, arguments, parameter_table())
        settings = node_settings.settings
        ParameterRequests(self, node_settings)
        keep_host_time(self)
        self._spec = DEVICES[node_settings.sensor]
        self._parts = parts = self._spec.parts(settings)
        self._link = _link(settings)
        self._live = live = parts.live(self._link)
        self._pipeline = parts.pipeline()
        self._reader = PortReader(self._link, self._pipeline, self.faults,
                                  live.requests.lock if live.requests else nullcontext())
        self._topics = Topics(self, self._spec, settings, parts.converter.select)
        self._time_task = TimeTask(parts.clock, parts.health.stale)
        self._link_task = self._create_link_task()
        self._updater = self._create_updater(settings)
        self._problems = self._create_problem_log()
        self._diagnostics = DiagnosticsPublisher(
            self._updater, self._topics.create_publisher(DiagnosticArray, TOPIC),
            self._topics.serialize, parts.health.device_id)
        self._nvm_services = self._create_services()
        self._subscribe_to_pulses(parts.pulse_topic)
        self._stopping = threading.Event()
        for warning in (*node_settings.warnings(), *parts.warnings, *self._topics.warnings):
            self._log.warning(warning)

    @property
    def threads(self) -> Mapping[str, Callable[[], None]]:
        """Functions that each run in a thread until stop() is called, by name."""
        requests = self._live.requests
        return {'the reading thread': self._read,
                'the watching thread': self._watch_until_stopped,
                **({'the requesting thread': requests.run} if requests else {})}

    def stop(self) -> None:
        """Make the threads end soon."""
        self._stopping.set()
        if self._live.requests:
            self._live.requests.stop()
        self._topics.stop_waiting()
        self._reader.stop()

    def leave_device(self) -> None:
        """Leave diagnostics mode if the driver entered it."""
        if self._live.nvm:
            self._live.nvm.end('the driver is ending')
        if self._nvm_services:
            self._nvm_services.wait()

    def _read(self) -> None:
        self._topics.wait_for_subscribers(self._log.info, self._log.warning)
        for event in self._reader.events():
            try:
                self._handle(event)
            except Exception as error:
                self.faults.report(f'handling the event {type(event).__name__}', error)

    def _handle(self, event: PortEvent) -> None:
        """Dispatch an event of the port."""
        match event:
            case BytesRead():
                self._handle_read(event)
            case StreamEnded():
                self._publish_events(event.events, time.monotonic())
            case Silence():
                self._publish_silence(time.monotonic())
            case PortOpened():
                self._begin_stream()
            case PortUsable():
                self._log.info(f'{self._link.name} is open')
                self._diagnostics.report_change()
            case PortUnavailable():
                self._end_stream(event)

    def _begin_stream(self) -> None:
        self._send_requests()
        self._parts.health.restart()
        self._diagnostics.report_change()

    def _send_requests(self) -> None:
        if self._live.requests:
            self._live.requests.send_due()

    def _end_stream(self, event: PortUnavailable) -> None:
        """Publish that data is lost, and log the reason unless it was logged before."""
        if not event.reported:
            self._log.error(event.reason)
        if self._live.nvm:
            self._live.nvm.abandon(event.reason)
        self.faults.survive('publishing that data is lost', lambda: self._topics.publish(
            self._parts.converter.end_stream(time.time_ns())))
        self._diagnostics.report_change()

    def _handle_read(self, event: BytesRead) -> None:
        """Publish the bytes of a read if publish.raw is set, and what they complete."""
        if event.events is not None:
            self._send_requests()       # first, because the line is idle after an answer
        if self._topics.raw:
            self.faults.survive('publishing raw', self._publish_bytes, self._topics.raw, event)
        now = time.monotonic()
        self._publish_silence(now)
        self._topics.flush()
        if event.events is not None:
            self._publish_events(event.events, now)

    def _publish_bytes(self, publisher: Publisher, event: BytesRead) -> None:
        (data, now), connection = event.reading, event.connection
        metadata = ReadMetadata(self._spec.name, connection.number, connection.byte_time_ns,
                                now.ros_ns, now.raw_ns)
        publisher.publish(self._topics.serialize(raw.message(data, metadata.to_label())))

    def _publish_silence(self, now: float) -> None:
        """Publish that the device is silent if its data is stale at a monotonic time."""
        if self._parts.health.stale(now):
            self._topics.publish(self._parts.converter.report_silence(time.time_ns()))

    def _publish_events(self, events: Sequence[Event], now: float) -> None:
        """Publish the messages of one read; log its notices and faults."""
        for event in events:
            if isinstance(event, Notice):
                self._log.warning(event.text)
                self._time_task.notice(event.text, now)
            elif isinstance(event, DecodingFault):
                self.faults.report('decoding a frame', event.error)
            else:
                self._handle_message(event, now)
        for notice in self._parts.take_notices():
            self._log.warning(notice)
        self.faults.survive('watching the clock', self._time_task.update, now)
        self._diagnostics.report_change()

    def _handle_message(self, stamped: Stamped, now: float) -> None:
        message, frame, stamp_ns = stamped
        try:
            self._topics.publish(self._parts.converter.convert(message, stamp_ns))
            self._topics.counters.converted += 1
        except Exception as error:
            self.faults.report(f'publishing {message.NAME}', error)
        self.faults.survive('watching the data', self._parts.health.observe, message, now)
        if self._live.nvm and self._live.nvm.reading:
            self.faults.survive('reading the memory', self._live.nvm.receive, message, frame)

    def _watch_until_stopped(self) -> None:
        """
        Do what needs no data, and report every second.

        A timer of the executor would do, but took more than twice the processor time.
        """
        survive, report_at = self.faults.survive, time.monotonic()
        while not self._stopping.wait(WATCH_PERIOD):
            survive('watching subscribers', self._watch_subscribers)
            survive('reporting a change', self._diagnostics.report_change)
            survive('logging problems', self._log_problems)
            if time.monotonic() >= report_at:
                report_at = time.monotonic() + DIAGNOSTICS_PERIOD
                survive('looking for other readers', self._link_task.check_sharing,
                        time.monotonic())
                survive('reporting diagnostics', self._diagnostics.report)

    def _watch_subscribers(self) -> None:
        """Find out which topics have subscribers, and serve the slow ones."""
        self._topics.refresh()
        if self.executor and self._topics.has_slow_subscribers:
            self.executor.create_task(self._topics.supervise)

    def _log_problems(self) -> None:
        # While the port is closed, its error is already in the log.
        is_open = self._reader.counters.open_since is not None
        self._problems.check(self._updater.latest if is_open else {}, time.monotonic())

    def _subscribe_to_pulses(self, topic: str) -> None:
        if not topic:
            return
        try:
            # A reliable subscription would receive nothing from a best-effort publisher.
            self.create_subscription(
                TimeReference, topic, self._on_pulse_reference,
                QoSProfile(depth=LEAST_QUEUE_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())
        except NameValidationException as error:
            raise ParameterError(
                f"parameter time.sync_pulse.reference is {topic!r}: it must be 'ros_clock' "
                'or the name of a topic') from error

    def _on_pulse_reference(self, message: TimeReference) -> None:
        self._parts.clock.pulse_reference(nanoseconds(message.header))

    def _create_services(self) -> NvmServices | None:
        self.create_service(SelfTest, '~/self_test', self._diagnostics.self_test)
        nvm, memory = self._live.nvm, self._spec.memory
        return NvmServices(self, nvm, memory.page_count, self.faults) if nvm and memory else None

    def _create_link_task(self) -> LinkTask:
        parts = self._parts
        return LinkTask(self._link, self._reader.counters, self._pipeline.counters,
                        parts.silence_timeout, parts.silence_hint, lambda: parts.health.lost)

    def _create_updater(self, settings: CommonSettings) -> Updater:
        spec, parts = self._spec, self._parts
        tasks: list[DiagnosticTask] = [
            self._link_task,
            FramingTask(self._pipeline.counters, self._link.baud_rate, spec.name,
                        parts.protocol, recognize, settings.diagnostics.damaged_share),
            self._time_task,
            *parts.health.tasks,
            *self._live.tasks,
            PublishingTask(self._topics.counters, parts.silence_timeout, self.faults)]
        label = node_label(self.get_name(), self.get_namespace(),
                           settings.diagnostics.qualified_name)
        return Updater(tasks, label, self._link.name, faults=self.faults)

    def _create_problem_log(self) -> ProblemLog:
        port = self._link.name
        return ProblemLog({'Link': f'{port} is in order again',
                           'Framing': f'{port}: frames arrive intact'},
                          self._log.error, self._log.info)


def _link(settings: CommonSettings) -> Link:
    try:
        return Link(settings.port, settings.baud_rate)
    except ValueError as error:
        raise ParameterError(f'parameter port is {settings.port!r}: {error}') from error
