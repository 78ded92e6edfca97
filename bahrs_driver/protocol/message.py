# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the messages of all devices have in common."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class Message:
    """Base of the messages of all devices: frozen dataclasses with SI values."""

    NAME: ClassVar[str]
    SERVICE: ClassVar[bool] = False             # about the device itself, not a measurement
    SIGNALS: ClassVar[tuple[str, ...]] = ()     # names of the signals in `health`, in order
    PROPERTIES: ClassVar[tuple[str, ...]] = ()  # properties that `bahrs decode` shows, too
