# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a device that streams numbered samples, by their role for a clock."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

Kind = type[Any]        # each role has fields of its own


@dataclass(frozen=True)
class MessageRoles:
    """
    Message types by role, and their rates.

    Samples and navigation messages have a `sequence`. A time message ties the `reference_sequence`
    of one of them to a `device_time_us`, unless it is not `valid`.
    """

    sample: Kind
    navigation: Kind
    sample_time: Kind
    navigation_time: Kind
    sync_pulse: Kind
    power_on: Kind                  # sent once, right after power-on
    service: Collection[Kind]       # sent only while the device does not stream
    sample_period: int              # ns, nominal
    samples_per_navigation: int
