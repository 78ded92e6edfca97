# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
All exceptions that this package raises.

The text of each is one or two sentences for the user: what happened, why, and what to do.
Mistakes of a caller, such as an argument of the wrong size, raise ValueError instead.

    BahrsDriverError
    +-- CommandError                a verb of the command line cannot do what it was asked to
    +-- ParameterError              a ROS parameter has an unusable value
    +-- RosStartError               ROS cannot start in this environment
    +-- LinkError                   the port cannot be used now
    +-- DeviceNotFound              no serial device matches a pattern
    +-- NvmError                    pages of the device's memory could not be read
    +-- CaptureError                a recording cannot be read
    +-- DamageError                 a part of a bag is unusable; the parts around it are not
    +-- WriteError                  a file or bag cannot be written
    |   +-- TargetExists            it exists and must not be replaced
    +-- ControlError                a command to the emulator is wrong (also a ValueError)
    +-- ScenarioError               a line of a scenario is wrong (also a ValueError)
"""


class BahrsDriverError(Exception):
    """Base of all exceptions of this package."""


class CommandError(BahrsDriverError):
    """A verb of the command line cannot do what it was asked to."""


class ParameterError(BahrsDriverError):
    """A parameter has an unusable value. The text names it, its value, and what would be valid."""


class RosStartError(BahrsDriverError):
    """ROS cannot start in this environment."""


class LinkError(BahrsDriverError):
    """The port cannot be used now; absent if the reason is that there is no such port."""

    def __init__(self, reason: str, absent: bool = False) -> None:
        super().__init__(reason)
        self.absent = absent


class DeviceNotFound(BahrsDriverError):
    """No serial device matches a pattern."""


class NvmError(BahrsDriverError):
    """Pages of the device's memory could not be read."""


class CaptureError(BahrsDriverError):
    """A recording cannot be read."""


class DamageError(BahrsDriverError):
    """A part of a bag is unusable. The parts around it are not affected."""


class WriteError(BahrsDriverError):
    """A file or bag cannot be written. The text is one sentence with the target and the reason."""


class TargetExists(WriteError):
    """The file to write exists and must not be replaced."""


class ControlError(BahrsDriverError, ValueError):
    """A command to the emulator is wrong. The text says what would be right."""


class ScenarioError(BahrsDriverError, ValueError):
    """A line of a scenario is wrong. The text names the line and what would be right."""
