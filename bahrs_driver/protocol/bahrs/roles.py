# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The roles of the messages of a BAHRS for its clock."""

from bahrs_driver.protocol.bahrs.messages import (
    Inertial, InertialTime, MESSAGES, Navigation, NavigationTime, SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.units import NS_PER_MS

ROLES = MessageRoles(
    sample=Inertial, navigation=Navigation, sample_time=InertialTime,
    navigation_time=NavigationTime, sync_pulse=SyncPulseTime, power_on=SoftwareVersion,
    service=frozenset(kind for kind in MESSAGES if kind.SERVICE),
    sample_period=5 * NS_PER_MS, samples_per_navigation=2)
