# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Measurement errors of a sensor: a constant bias and white noise."""

from collections.abc import Iterator, Mapping
import math
import random

from bahrs_driver.emulator.motion import TURN
from bahrs_driver.process.text_values import known, number
from bahrs_driver.protocol.layout import Vector

# Quantities with measurement errors, and their numbers of components.
COMPONENTS = {'specific_force': 3, 'angular_rate': 3, 'attitude': 3, 'pressure_height': 1,
              'velocity_down': 1}

# Standard deviations between successive samples of a real device at rest. The output of its
# navigation filter is smooth to within a quantum.
DEVIATIONS = {'specific_force': 0.008, 'angular_rate': 3.5e-4, 'attitude': 0.0,
              'pressure_height': 0.0, 'velocity_down': 0.0}

Values = tuple[float, ...]


def parse_deviation(text: str) -> tuple[str, float]:
    """Parse a quantity and its standard deviation, such as angular_rate=0.001."""
    name, _, value = text.partition('=')
    return known(name, 'quantity', COMPONENTS), number(value, f'the noise of {name}')


def parse_bias(text: str) -> tuple[str, Values]:
    """Parse a quantity and its bias, such as specific_force=0.1,0,-0.2."""
    name, _, words = text.partition('=')
    components = COMPONENTS[known(name, 'quantity', COMPONENTS)]
    values = tuple(number(word, f'the bias of {name}', -math.inf) for word in words.split(','))
    if len(values) != components:
        raise ValueError(f'the bias of {name} has {components} components, not {len(values)}')
    return name, values


class MeasurementErrors:
    """Adds bias and noise to true values. The same seed gives the same noise."""

    def __init__(self, seed: int, deviations: Mapping[str, float] | None = None,
                 biases: Mapping[str, Values] | None = None) -> None:
        self._noise = _standard_normal(random.Random(f'noise {seed}'))
        self._deviations = {name: (deviations or {}).get(name, 0.0) for name in COMPONENTS}
        self._biases = {name: (biases or {}).get(name, (0.0,) * count)
                        for name, count in COMPONENTS.items()}

    def add(self, quantity: str, value: float) -> float:
        """Return the measured value of a quantity with one component."""
        bias, = self._biases[quantity]
        deviation = self._deviations[quantity]
        return value + bias + deviation * next(self._noise) if deviation else value + bias

    def add_vector(self, quantity: str, vector: Vector) -> Vector:
        """Return the measured vector of a quantity."""
        x, y, z = vector
        bias_x, bias_y, bias_z = self._biases[quantity]
        deviation, noise = self._deviations[quantity], self._noise
        if not deviation:
            return x + bias_x, y + bias_y, z + bias_z
        return (x + bias_x + deviation * next(noise), y + bias_y + deviation * next(noise),
                z + bias_z + deviation * next(noise))


def _standard_normal(source: random.Random) -> Iterator[float]:
    """
    Yield independent numbers of mean 0 and standard deviation 1.

    They are those of source.gauss(0.0, 1.0), in half of the time.
    """
    draw, log, sqrt, cos, sin = source.random, math.log, math.sqrt, math.cos, math.sin
    while True:
        angle, radius = draw() * TURN, sqrt(-2.0 * log(1.0 - draw()))
        yield cos(angle) * radius
        yield sin(angle) * radius


def clamp(value: float, limit: float) -> float:
    """Limit a value to the range from -limit to limit."""
    if -limit <= value <= limit:
        return value
    return max(-limit, min(limit, value))


def clamp_vector(vector: Vector, limit: float) -> Vector:
    """Limit each component to the range from -limit to limit."""
    x, y, z = vector
    if -limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit:
        return vector
    return clamp(x, limit), clamp(y, limit), clamp(z, limit)
