# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs monitor`: the driver's topics, live."""

import argparse
from collections import deque
from collections.abc import Callable
from functools import partial
import math
import os
import time
from typing import Any

from bahrs_driver.convert.bahrs import LATCHED, TOPICS as BAHRS_TOPICS
from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from bahrs_driver.convert.titan_m import TOPICS as TITAN_TOPICS
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, qos_profile_sensor_data, QoSProfile
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table

RATE_WINDOW = 2.0           # s over which a rate is measured
REFRESH = 0.25              # s
TOPICS = {**BAHRS_TOPICS, **TITAN_TOPICS}

_EXAMPLES = """examples:
  bahrs monitor                   until Ctrl-C
  bahrs monitor --duration 15     then print what came
"""
_LATCHED_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_LEVELS = {DiagnosticStatus.OK: ('OK', 'green'), DiagnosticStatus.WARN: ('WARN', 'yellow'),
           DiagnosticStatus.ERROR: ('ERROR', 'red'), DiagnosticStatus.STALE: ('STALE', 'blue')}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Show rate and latest value of each topic of the driver, and its diagnostics.\n'
        'At the end the last state stays as a table.')
    parser.epilog = _EXAMPLES
    parser.add_argument('--duration', type=float, metavar='SECONDS',
                        help='end after this time (default: at Ctrl-C)')
    parser.add_argument('--namespace', default='', metavar='NAME',
                        help='namespace of the driver and its topics (default: none)')


def run(options: argparse.Namespace) -> int:
    """Watch until the time is up or Ctrl-C; 1 if no driver was heard."""
    rclpy.init(args=[])
    watch = Watch(rclpy.create_node(f'bahrs_monitor_{os.getpid()}', namespace=options.namespace))
    console = Console()
    end = math.inf if options.duration is None else time.monotonic() + options.duration
    try:
        # Where output is no terminal, rich prints the last state only.
        with Live(console=console, auto_refresh=False) as live:
            while time.monotonic() < end:
                watch.spin(min(REFRESH, end - time.monotonic()))
                live.update(watch.table(), refresh=True)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0 if watch.heard else 1


class Tally:
    """What came on one topic."""

    def __init__(self) -> None:
        """Start with nothing."""
        self.count = 0
        self.value = ''
        self._arrivals: deque[float] = deque()

    def add(self, value: str) -> None:
        """Count a message and keep its value."""
        self.count += 1
        self.value = value
        self._arrivals.append(time.monotonic())

    def rate(self) -> float:
        """Return messages per second over the last RATE_WINDOW."""
        now = time.monotonic()
        while self._arrivals and now - self._arrivals[0] > RATE_WINDOW:
            self._arrivals.popleft()
        if len(self._arrivals) < 2:
            return 0.0
        return (len(self._arrivals) - 1) / (self._arrivals[-1] - self._arrivals[0])


class Watch:
    """Listens to the driver's topics and draws what it hears."""

    def __init__(self, node: Node) -> None:
        """Subscribe."""
        self._node = node
        self._tallies = {topic: Tally() for topic in TOPICS}
        self._health: dict[str, DiagnosticStatus] = {}
        for topic, kind in TOPICS.items():
            profile = _LATCHED_PROFILE if topic in LATCHED else qos_profile_sensor_data
            node.create_subscription(
                kind, topic, partial(self._count, topic, _FORMATS[topic]), profile)
        node.create_subscription(DiagnosticArray, '/diagnostics', self._judge, 10)

    @property
    def heard(self) -> bool:
        """Whether any driver was there."""
        return bool(self._health) or any(tally.count for tally in self._tallies.values())

    def spin(self, seconds: float) -> None:
        """Listen for a while."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            rclpy.spin_once(self._node, timeout_sec=left)

    def table(self) -> Group:
        """Return the present state."""
        topics = Table('Topic', 'Hz', 'Count', 'Latest (SI)', box=None, pad_edge=False)
        for name, tally in self._tallies.items():
            if not tally.count and not self._node.count_publishers(name):
                continue        # of another device
            topics.add_row(name, f'{tally.rate():.1f}', f'{tally.count:,}', tally.value)
        health = Table('Task', 'Level', 'Message', box=None, pad_edge=False)
        for name, status in self._health.items():
            word, colour = _LEVELS[status.level]
            health.add_row(name, f'[{colour}]{word}[/]', status.message)
        if not self._health:
            health.add_row('no driver heard yet', '', 'is driver_node running, and is '
                           'ROS_DOMAIN_ID the same?')
        return Group(topics, '', health)

    def _count(self, topic: str, form: Callable[[Any], str], message: Any) -> None:
        self._tallies[topic].add(form(message))

    def _judge(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if 'bahrs_driver: ' in status.name:         # or the qualified name of the node
                self._health[status.name] = status


def _force_and_rate(imu: Any) -> str:
    force, rate = imu.linear_acceleration, imu.angular_velocity
    return (f'f {force.x:+.2f} {force.y:+.2f} {force.z:+.2f}  '
            f'ω {rate.x:+.3f} {rate.y:+.3f} {rate.z:+.3f}')


def _attitude(imu: Any) -> str:
    if imu.orientation_covariance[0] < 0:
        return 'no orientation'
    q = imu.orientation
    roll = math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x ** 2 + q.y ** 2))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.z * q.x))))
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y ** 2 + q.z ** 2))
    return (f'roll {math.degrees(roll):+.2f}° pitch {math.degrees(pitch):+.2f}° '
            f'yaw {math.degrees(yaw):+.2f}°')


def _field(message: Any) -> str:
    field = message.magnetic_field
    return f'{field.x * 1e6:+.1f} {field.y * 1e6:+.1f} {field.z * 1e6:+.1f} µT'


def _velocity(message: Any) -> str:
    velocity, known = message.twist.twist.linear, message.twist.covariance[0] < UNKNOWN_VARIANCE
    across = f'x {velocity.x:+.2f} y {velocity.y:+.2f} ' if known else ''
    return f'{across}z {velocity.z:+.2f} m/s'


def _position(fix: Any) -> str:
    if fix.status.status < 0:
        return 'no fix'
    return f'{fix.latitude:+.7f}° {fix.longitude:+.7f}° {fix.altitude:.1f} m'


def _odometry(message: Any) -> str:
    position = message.pose.pose.position
    return f'x {position.x:+.1f} y {position.y:+.1f} z {position.z:+.1f} m'


def _integrity(notice: Any) -> str:
    troubled = [f'{status.name} {status.message}' for status in notice.status
                if status.level != DiagnosticStatus.OK]
    return ', '.join(troubled) or 'all signals safe'


def _device_time(reference: Any) -> str:
    time = reference.time_ref
    clock = 'GPS' if reference.source == 'gps' else 'device'
    return f'{clock} time {time.sec + time.nanosec * 1e-9:.6f} s'


_FORMATS: dict[str, Callable[[Any], str]] = {
    'imu/data_raw': _force_and_rate,
    'imu/data': _attitude,
    'imu/mag': _field,
    'static_pressure': lambda message: f'{message.fluid_pressure / 100:.2f} hPa',
    'pressure_altitude': lambda message: f'{message.altitude:.1f} m',
    'altitude/pose': lambda message: f'z {message.pose.pose.position.z:+.1f} m',
    'velocity': _velocity,
    'differential_pressure': lambda message: f'{message.fluid_pressure:.1f} Pa',
    'temperature': lambda message: f'{message.temperature:.1f} °C',
    'fix': _position,
    'odometry': _odometry,
    'heading': lambda message: 'unavailable' if math.isnan(message.data)
    else f'{message.data:.1f}°',
    'integrity': _integrity,
    'time_reference': _device_time,
    'sync_pulse': _device_time,
}
