# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the filter of robot_localization does with messages, as read in its source (3.6.0, ros2).

It is not installed where these tests run. The model has the state, the motion, and the way of
each kind of message into it, with the peculiarities that matter to a driver:

- A message in a frame without a transform is dropped, as is one that is older than the last.
- A quantity of an Imu message with a covariance of -1 is ignored.
- A vector is transformed whole, so one NaN spoils all three components. Later, NaN is left out of
  an update; but the first measurement becomes the state, NaN included.
- A variance below 1e-9 becomes 1e-9.
- A velocity in the world frame gets, in addition, the cross product of the position of that frame
  and the angular rate, as if the sensor stood there.

Whatever of this must not happen to a message of the driver is noted as a problem.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import cos, pi, sin, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE = 15
POSITION, ANGLES, VELOCITY, RATE, ACCELERATION = (slice(i, i + 3) for i in range(0, SIZE, 3))
SMALLEST_VARIANCE = 1e-9
# What a message of each kind can measure.
MEASURED = {'imu': {*range(3, 6), *range(9, SIZE)}, 'pose': set(range(6)),
            'twist': set(range(6, 12)), 'odom': set(range(12))}
S = 1_000_000_000


@dataclass(frozen=True)
class Source:
    """An input of the filter: its kind, its topic, and the indices of what it measures."""

    name: str
    topic: str
    used: frozenset[int]

    @property
    def kind(self) -> str:
        """Return the kind of its messages."""
        return self.name.rstrip('0123456789')


def sources(parameters: Mapping[str, Any]) -> list[Source]:
    """Return the inputs of a parameter file."""
    names = [name for name in parameters if name.rstrip('0123456789') in MEASURED]
    return [Source(name, parameters[name], frozenset(
        index for index, used in enumerate(parameters[f'{name}_config']) if used))
        for name in names]


def rotation(roll: float, pitch: float, yaw: float) -> Array:
    """Return the matrix that turns body axes into those of the world."""
    sr, cr, sp, cp, sy, cy = sin(roll), cos(roll), sin(pitch), cos(pitch), sin(yaw), cos(yaw)
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def angles(matrix: Array) -> Array:
    """Return roll, pitch and yaw of a matrix."""
    return np.array([np.arctan2(matrix[2, 1], matrix[2, 2]), -np.arcsin(matrix[2, 0]),
                     np.arctan2(matrix[1, 0], matrix[0, 0])])


def of_quaternion(q: Any) -> Array:
    """Return the matrix of a quaternion message of any length but 0."""
    x, y, z, w = np.array([q.x, q.y, q.z, q.w]) / np.linalg.norm([q.x, q.y, q.z, q.w])
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def xyz(vector: Any) -> Array:
    """Return a vector message as an array."""
    return np.array([vector.x, vector.y, vector.z])


def wrap(angle: Array) -> Array:
    """Return angles from -pi to pi."""
    return (angle + pi) % (2 * pi) - pi


class Filter:
    """The extended Kalman filter, and what it noticed of its messages."""

    def __init__(self, parameters: Mapping[str, Any],
                 frames: Mapping[str, tuple[Array, Array]]) -> None:
        """Start with parameters, and position and rotation of frames in base_link."""
        self.state: Array = np.zeros(SIZE)
        self.covariance = np.diag(parameters['initial_estimate_covariance'])
        self.problems: set[str] = set()
        self.used: Counter[str] = Counter()     # messages by source and part
        self._noise = np.diag(parameters['process_noise_covariance'])
        self._world = parameters['world_frame']
        self._frames = frames
        self.time_ns = 0                        # of the state
        self._last: dict[str, int] = {}

    @property
    def velocity(self) -> Array:
        """Return the velocity in axes of the world."""
        return rotation(*self.state[ANGLES]) @ self.state[VELOCITY]

    def take(self, source: Source, message: Any) -> None:
        """Predict to the time of a message, and use what its source measures."""
        stamp = message.header.stamp.sec * S + message.header.stamp.nanosec
        if stamp <= self._last.get(source.name, 0):
            self._report(source, f'stamp {stamp} is not later than the one before')
        self._last[source.name] = stamp
        for part, indices, values, spread in self._parts(source, message):
            self._check(source, part, indices, values, spread)
            self.used[f'{source.name} {part}'] += 1
            self._measure(stamp, np.array(indices), values, spread)

    def _parts(self, source: Source, message: Any
               ) -> Iterator[tuple[str, list[int], Array, Array]]:
        """Yield name, indices, values and covariance of each part of a message."""
        makers = {'imu': (self._orientation, self._rate), 'pose': (self._pose,),
                  'twist': (self._twist,), 'odom': (self._pose, self._twist)}
        for make in makers[source.kind]:
            made = make(source, message)
            if made:
                part, chosen, values, spread = made
                at = [index - chosen[0] for index in chosen[1]]
                if at:
                    yield part, chosen[1], values[at], spread[np.ix_(at, at)]

    def _orientation(self, source: Source, message: Any) -> Any:
        spread = np.reshape(message.orientation_covariance, (3, 3))
        if not source.used & {3, 4, 5} or spread[0, 0] == -1:
            return None
        _, mounting = self._frame(source, message.header.frame_id)
        turn = rotation(0.0, 0.0, angles(mounting)[2])
        # Differences of angles: exact if the device is turned about z only.
        values = turn @ wrap(angles(of_quaternion(message.orientation)) - angles(mounting))
        return 'orientation', (3, sorted(source.used & {3, 4, 5})), values, turn @ spread @ turn.T

    def _rate(self, source: Source, message: Any) -> Any:
        spread = np.reshape(message.angular_velocity_covariance, (3, 3))
        used = source.used & {9, 10, 11}
        if not used or spread[0, 0] == -1:
            return None
        _, turn = self._frame(source, message.header.frame_id)
        return ('rate', (9, _turned(turn, used, 9)), turn @ xyz(message.angular_velocity),
                turn @ spread @ turn.T)

    def _pose(self, source: Source, message: Any) -> Any:
        used = source.used & set(range(6))
        if used and message.header.frame_id != self._world:
            self._report(source, f'frame {message.header.frame_id} is not {self._world}')
        values = np.hstack([xyz(message.pose.pose.position),
                            angles(of_quaternion(message.pose.pose.orientation))])
        return 'pose', (0, sorted(used)), values, np.reshape(message.pose.covariance, (6, 6))

    def _twist(self, source: Source, message: Any) -> Any:
        used = source.used & {6, 7, 8}
        if not used:
            return None
        frame = getattr(message, 'child_frame_id', message.header.frame_id)
        position, turn = self._frame(source, frame)
        values = turn @ xyz(message.twist.twist.linear) + np.cross(position, self.state[RATE])
        spread = np.reshape(message.twist.covariance, (6, 6))[:3, :3]
        return 'velocity', (6, _turned(turn, used, 6)), values, turn @ spread @ turn.T

    def _frame(self, source: Source, frame_id: str) -> tuple[Array, Array]:
        """Return position and rotation of a frame in base_link."""
        if frame_id == self._world:
            turn = rotation(*self.state[ANGLES]).T
            return -turn @ self.state[POSITION], turn
        if frame_id not in self._frames:
            self._report(source, f'no transform from {frame_id}')
            return np.zeros(3), np.eye(3)
        return self._frames[frame_id]

    def _report(self, source: Source, text: str) -> None:
        self.problems.add(f'{source.topic}: {text}')

    def _check(self, source: Source, part: str, indices: Sequence[int], values: Array,
               spread: Array) -> None:
        if not np.isfinite(values).all():
            self._report(source, f'{part} has a NaN' + (
                '' if self.time_ns else ', which becomes the state'))
        if not np.isfinite(spread).all() or not np.allclose(spread, spread.T):
            self._report(source, f'{part} has no covariance')
        elif np.linalg.eigvalsh(spread).min() < SMALLEST_VARIANCE:
            self._report(source, f'{part} has a variance of 0')

    def _measure(self, stamp: int, indices: Any, values: Array, spread: Array) -> None:
        if not self.time_ns:
            self.time_ns = stamp
            self.state[indices] = values
            self.covariance[np.ix_(indices, indices)] = spread
            return
        self._predict((stamp - self.time_ns) / S)
        self.time_ns = max(stamp, self.time_ns)
        known = np.isfinite(values)
        self._correct(indices[known], values[known], spread[np.ix_(known, known)])

    def _moved(self, state: Array, seconds: float) -> Array:
        """Return the state after a time, with body velocity and rate that stay."""
        roll, pitch, yaw = state[ANGLES]
        euler = np.array([[1, sin(roll) * tan(pitch), cos(roll) * tan(pitch)],
                          [0, cos(roll), -sin(roll)],
                          [0, sin(roll) / cos(pitch), cos(roll) / cos(pitch)]])
        moved = state.copy()
        moved[POSITION] += rotation(roll, pitch, yaw) @ (
            state[VELOCITY] * seconds + state[ACCELERATION] * seconds ** 2 / 2)
        moved[ANGLES] += euler @ state[RATE] * seconds
        moved[VELOCITY] += state[ACCELERATION] * seconds
        return moved

    def _predict(self, seconds: float) -> None:
        if seconds <= 0:
            return
        moved, step = self._moved(self.state, seconds), 1e-6
        slopes = np.array([(self._moved(self.state + step * unit, seconds) - moved) / step
                           for unit in np.eye(SIZE)]).T
        self.covariance = slopes @ self.covariance @ slopes.T + self._noise * seconds
        self.state = moved
        self.state[ANGLES] = wrap(moved[ANGLES])

    def _correct(self, indices: Any, values: Array, spread: Array) -> None:
        spread = spread + np.diag(np.maximum(SMALLEST_VARIANCE - np.diag(spread), 0.0))
        both = np.ix_(indices, indices)
        gain = self.covariance[:, indices] @ np.linalg.inv(self.covariance[both] + spread)
        innovation = values - self.state[indices]
        of_angle = (indices >= ANGLES.start) & (indices < ANGLES.stop)
        innovation[of_angle] = wrap(innovation[of_angle])
        self.state = self.state + gain @ innovation
        self.state[ANGLES] = wrap(self.state[ANGLES])
        rest = np.eye(SIZE)
        rest[:, indices] -= gain
        self.covariance = rest @ self.covariance @ rest.T + gain @ spread @ gain.T


def _turned(turn: Array, used: Any, first: int) -> list[int]:
    """Return the indices of what is measured of a vector after it was turned."""
    chosen = np.array([first + axis in used for axis in range(3)], dtype=float)
    lengths = np.linalg.norm(turn * chosen, axis=1)
    return [first + axis for axis in range(3) if lengths[axis] >= 1e-6]
