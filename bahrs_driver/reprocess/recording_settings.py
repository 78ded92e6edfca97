# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a conversion, from values of parameters."""

from collections.abc import Callable, Mapping

from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.errors import ParameterError
from bahrs_driver.settings.group import parameters
from bahrs_driver.settings.table import SENSOR

# Prefixes of the parameters that only a driver with a port uses.
LIVE_ONLY = ('port', 'publish.raw', 'publish.static_tf', 'publish.tf', 'nvm.', 'startup.',
             'diagnostics.qualified_name')


def recording_settings(given: Mapping[str, object], sensor: str,
                       describe: Callable[[str], str]) -> tuple[CommonSettings, list[str]]:
    """
    Return the settings for a recording of a device, and sentences about values without effect.

    given has values of parameters by name, which must exist. ParameterError if one is invalid;
    describe returns how its sentence names a parameter that the user gave.
    """
    table = parameter_table()
    values = table.values({SENSOR: sensor, **given})
    if values[SENSOR] != sensor:
        raise ParameterError(f'{describe(SENSOR)}: choose {values[SENSOR]} as the sensor instead')
    settings = table.settings(values)[1].for_recording()
    for row in parameters(settings):
        if row.name in given and values[row.name] != row.default \
                and not row.name.startswith(LIVE_ONLY):
            raise ParameterError(f'{describe(row.name)}: it must be 0, because a conversion '
                                 'sends no requests')
    notes = [note for name in given if (note := table.by_name[name].correction(given[name]))]
    unused = [*table.unused(given, sensor, settings),
              *(f'{name} (it is for a port)' for name in given if name.startswith(LIVE_ONLY))]
    if unused:
        notes.append(f'settings without effect: {"; ".join(unused)}')
    return settings, notes
