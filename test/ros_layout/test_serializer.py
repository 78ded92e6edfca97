# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A message definition that differs is published as a message object."""

from bahrs_driver.convert.values import FluidPressure, Temperature
from bahrs_driver.ros_layout import serializer
from bahrs_driver.ros_layout.serializer import Serializer
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import (
    FluidPressure as FluidPressureMessage, Temperature as TemperatureMessage,
)

PRESSURE = FluidPressure(1_500_000_000, 'imu_link', 101_325.0, 4.0)


def test_values_become_bytes():
    """No definition differs from that of this version of ROS."""
    found = Serializer()
    assert found.warnings() == []
    message = deserialize_message(found.serialize(PRESSURE), FluidPressureMessage)
    assert message.fluid_pressure == 101_325.0 and message.header.stamp.nanosec == 500_000_000


def test_definition_that_differs(monkeypatch):
    """Its values become message objects, the others bytes; one warning names the type."""
    matches = serializer.matches
    monkeypatch.setattr(serializer, 'matches', lambda layout: (
        layout.name != 'sensor_msgs/msg/FluidPressure' and matches(layout)))
    found = Serializer()
    (warning,) = found.warnings()
    assert warning.startswith('sensor_msgs/msg/FluidPressure: the definition differs')
    message = found.serialize(PRESSURE)
    assert isinstance(message, FluidPressureMessage) and message.variance == 4.0
    temperature = found.serialize(Temperature(0, '', 21.5, 0.0))
    assert deserialize_message(temperature, TemperatureMessage).temperature == 21.5
