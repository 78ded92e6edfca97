# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""All devices of the driver. No other module lists them."""

from collections.abc import Callable
from typing import Any

from bahrs_driver.devices.bahrs.spec import BahrsSpec
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.devices.titan_m.spec import TitanSpec
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.settings.table import ParameterTable

DEVICES: dict[str, AnyDevice] = {spec.name: spec for spec in (BahrsSpec(), TitanSpec())}
DEFAULT = 'bahrs'


def parameter_table() -> ParameterTable[CommonSettings]:
    """Return the parameters of all devices."""
    return ParameterTable({name: spec.settings for name, spec in DEVICES.items()})


def examples(verb: str) -> str:
    """Return the lines that devices add to the examples in the help of a verb."""
    return ''.join(spec.examples.get(verb, '') for spec in DEVICES.values())


def all_topics() -> dict[str, type]:
    """Return the class of the values of each topic of any device."""
    return {topic: kind for spec in DEVICES.values() for topic, kind in spec.topics().items()}


def all_latched() -> set[str]:
    """Return the topics of any device whose last message a late subscriber receives."""
    return {topic for spec in DEVICES.values() for topic in spec.latched()}


def all_formats() -> dict[str, Callable[[Any], str]]:
    """Return the function that shows a message as text, for topics that need their own."""
    return {topic: show for spec in DEVICES.values() for topic, show in spec.formats().items()}


def recognize(data: bytes) -> str:
    """Return the name of the device whose frames the data contains; empty if none matches."""
    for spec in DEVICES.values():
        framer = Framer(spec.frame_format())
        framer.feed(data)
        framer.flush()
        if framer.counters.frames:
            return spec.name
    return ''
