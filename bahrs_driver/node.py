# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node: it wires the parts together, and nothing else."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
import signal
import sys
from threading import Event
from typing import Any

from bahrs_driver.diagnostics import Monitor
from bahrs_driver.link import Link
from bahrs_driver.parameters import declare, ParameterError, unknown_names
from bahrs_driver.receiver import Received, Receiver
from bahrs_driver.sensors import SENSORS
from diagnostic_msgs.msg import DiagnosticArray
import rclpy
from rclpy._rclpy_pybind11 import RCLError, RCLInvalidROSArgsError
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import InvalidQosOverridesError, QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

QUEUE_DEPTH = 100               # half a second of the fastest topic
DIAGNOSTICS_PERIOD = 1.0        # s


class DriverNode(Node):
    """Publishes what a sensor on a serial port says, and how the link to it is doing."""

    def __init__(self) -> None:
        """Read the parameters and make the parts; ParameterError if one is bad."""
        super().__init__('bahrs_driver', automatically_declare_parameters_from_overrides=True)
        settings = declare(self)
        for sentence in unknown_names(self):
            self.get_logger().warning(sentence)
        self._sensor = SENSORS[settings['sensor']](settings)
        self._data = {topic: self._publisher(message_type, topic)
                      for topic, message_type in self._sensor.topics.items()}
        self._diagnostics = self._publisher(DiagnosticArray, '/diagnostics')
        link = _link(settings)
        self.receiver = Receiver(link, self._sensor.framer, self._sensor.codec, self)
        self._monitor = Monitor(link, self.receiver, self._sensor.framer, self._sensor.protocol)
        self._port = link.port
        self.create_timer(DIAGNOSTICS_PERIOD, self._report)

    def link_opened(self) -> None:
        """Note that another stream begins."""
        self.get_logger().info(f'{self._port} is open')
        self._sensor.converter.reset()
        self._publish_diagnostics()

    def link_failed(self, reason: str) -> None:
        """Tell why there is no data."""
        self.get_logger().error(reason)
        self._publish_diagnostics()

    def received(self, batch: list[Received]) -> None:
        """Publish what the messages of one read become."""
        for message, _, stamp_ns in batch:
            for topic, outgoing in self._sensor.converter.convert(message, stamp_ns):
                self._data[topic].publish(outgoing)

    def _report(self) -> None:
        self._monitor.update()
        self._publish_diagnostics()

    def _publish_diagnostics(self) -> None:
        array = DiagnosticArray(status=self._monitor.statuses())
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)

    def _publisher(self, message_type: type, topic: str) -> Publisher:
        try:
            return self.create_publisher(
                message_type, topic, QoSProfile(depth=QUEUE_DEPTH),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())
        except (InvalidQosOverridesError, RuntimeError, TypeError) as error:
            raise ParameterError(f'qos_overrides of {topic} cannot be used: {error}') from error


def _link(settings: Mapping[str, Any]) -> Link:
    try:
        return Link(settings['port'], settings['baud_rate'])
    except ValueError as error:
        raise ParameterError(f"parameter port is {settings['port']!r}: {error}") from error


def main(args: list[str] | None = None) -> int:
    """Run the node until a signal ends it; the exit status is not 0 if it could not start."""
    ended = Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    try:
        _check_words(remove_ros_args(sys.argv if args is None else args)[1:])
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        _run(ended)
    except (ParameterError, RCLError, RCLInvalidROSArgsError) as error:
        # What rcl says ends in places of its source.
        print('bahrs_driver:', str(error).split(', at /')[0], file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


def _run(ended: Event) -> None:
    """
    Receive and spin, each in its thread, until ended or until one of them fails.

    The main thread waits for the signal, so that the port is let go while ROS is still whole.
    """
    node = DriverNode()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    with ThreadPoolExecutor(max_workers=2) as pool:
        threads = [pool.submit(node.receiver.run), pool.submit(executor.spin)]
        for thread in threads:
            thread.add_done_callback(lambda _: ended.set())
        ended.wait()
        node.receiver.stop()
        executor.shutdown()
        for thread in threads:
            thread.result()
    node.destroy_node()


def _check_words(words: list[str]) -> None:
    if words:
        raise ParameterError(f'{words[0]!r} is not understood: parameters are given as '
                             '--ros-args -p port:=/dev/ttyUSB0')
