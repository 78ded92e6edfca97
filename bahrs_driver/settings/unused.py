# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Settings that the user gave and that have no effect, each with the reason."""

from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from typing import Any

from bahrs_driver.process.printable import printable
from bahrs_driver.settings.parameter import Parameter, shown
from bahrs_driver.settings.qos_overrides import PREFIX
from bahrs_driver.settings.table import PARAMETERS, TITAN_M

RATES = ('state.rate', 'sensors.rate', 'gps.rate')
# Parameters for what only one kind of answer of a titan_m has.
_OF_ANSWERS = {
    'state.rate': ('stddev.attitude', 'stddev.heading', 'magnetic_field.declination'),
    'sensors.rate': ('stddev.specific_force', 'stddev.magnetic_field', 'stddev.static_pressure',
                     'stddev.differential_pressure', 'stddev.temperature'),
    'gps.rate': ('gps.week', 'gps.leap_seconds', 'gps.geoid_height'),
}
_RATE_OF = {name: rate for rate, names in _OF_ANSWERS.items() for name in names}


def why_unused(parameter: Parameter, settings: Mapping[str, Any]) -> str | None:
    """Return why a parameter has no effect beside the values of the others, if it has none."""
    if parameter.sensor not in ('', settings['sensor']):
        return f"sensor is {settings['sensor']}"
    for name, values in (parameter.needs or {}).items():
        if settings[name] not in values:
            return f'{name} is {shown(settings[name])}'
    if parameter.name == 'baud_rate' and settings['port'].startswith('socket://'):
        return 'port is a socket'
    if settings['sensor'] == TITAN_M:
        return _why_not_asked(parameter.name, settings)
    return None


def unused_parameters(names: Mapping[str, Any], settings: Mapping[str, Any]) -> Iterator[str]:
    """Yield those of some parameters of the driver that have no effect, with the reason."""
    for parameter in PARAMETERS:
        reason = why_unused(parameter, settings) if parameter.name in names else None
        if reason:
            yield f'{parameter.name} ({reason})'


def unknown_parameter(name: str, known: list[str]) -> str:
    """Return a name that no parameter has, with the one that was probably meant."""
    near = get_close_matches(name, known, n=1)
    kind = 'there is no such publisher, subscription or policy' if name.startswith(PREFIX) \
        else 'there is no such parameter'
    return f'{printable(name)} ({kind}{f", did you mean {near[0]}?" if near else ""})'


def _why_not_asked(name: str, settings: Mapping[str, Any]) -> str | None:
    """Return why a parameter of a titan_m has no effect with the rates that it is asked at."""
    if not any(settings[rate] for rate in RATES):
        return f'{", ".join(RATES)} are 0' if name.startswith('request.') else None
    rate = _RATE_OF.get(name)
    return f'{rate} is 0' if rate and not settings[rate] else None
