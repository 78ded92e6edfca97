# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the messages of all devices have in common."""

from typing import ClassVar


class Message:
    """A message of a device: a frozen dataclass with SI values."""

    __slots__ = ()
    NAME: ClassVar[str]
    SERVICE: ClassVar[bool] = False             # about the device itself, not a measurement
    SIGNALS: ClassVar[tuple[str, ...]] = ()     # names of the signals in `health`, in order
    PROPERTIES: ClassVar[tuple[str, ...]] = ()  # properties that `bahrs decode` shows, too
