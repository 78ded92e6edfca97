# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a conversion, from the options -p NAME:=VALUE."""

import argparse
from collections.abc import Sequence
import contextlib

from bahrs_driver.devices.registry import parameter_table
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.settings.group import parameters
from bahrs_driver.settings.table import ParameterTable, SENSOR, unknown_parameter
import yaml

# Prefixes of the parameters that only a driver with a port uses.
LIVE_ONLY = ('port', 'publish.raw', 'publish.static_tf', 'publish.tf', 'nvm.', 'startup.',
             'diagnostics.qualified_name')


def read_settings(rules: Sequence[str], sensor: str) -> tuple[CommonSettings, list[str]]:
    """
    Return the settings for a recording, and sentences about rules without effect.

    CommandError or ParameterError if a rule is invalid.
    """
    table = parameter_table()
    given: dict[str, object] = {}
    rule_of: dict[str, str] = {}
    for rule in rules:
        name, value = _parse(rule, table)
        given[name] = value
        rule_of[name] = printable(rule)
    values = table.values({SENSOR: sensor, **given})
    if values[SENSOR] != sensor:
        raise CommandError(f'-p {rule_of[SENSOR]}: write --sensor {values[SENSOR]} instead')
    settings = table.settings(values)[1].for_recording()
    for row in parameters(settings):
        if row.name in given and values[row.name] != row.default \
                and not row.name.startswith(LIVE_ONLY):
            raise CommandError(f'-p {rule_of[row.name]}: it must be 0, because a conversion sends '
                               'no requests')
    notes = [note for name in given if (note := table.by_name[name].correction(given[name]))]
    unused = [*table.unused(given, sensor, settings),
              *(f'{name} (it is for a port)' for name in given if name.startswith(LIVE_ONLY))]
    if unused:
        notes.append(f'settings without effect: {"; ".join(unused)}')
    return settings, notes


def unused_options(options: argparse.Namespace, timed: bool) -> list[str]:
    """Return at most one sentence, about the options without effect."""
    unused = []
    if options.start is not None and timed:
        unused.append('--start (the recording has times)')
    if options.topic is not None and not timed:
        unused.append('--topic (a file of bytes has no topics)')
    if options.namespace and options.kind == 'csv':
        unused.append('--namespace (CSV files are named after topics without it)')
    return [f'options without effect: {"; ".join(unused)}'] if unused else []


def _parse(rule: str, table: ParameterTable[CommonSettings]) -> tuple[str, object]:
    """Return the name and the value of a rule; CommandError if it is invalid."""
    name, _, text = rule.partition(':=')
    if not name or not text:
        raise CommandError(f'-p {printable(rule)}: it must be NAME:=VALUE, with the name of a '
                           'parameter')
    if name not in table.by_name:
        raise CommandError(f'-p {printable(rule)}: {unknown_parameter(name, table.by_name)}')
    try:
        value: object = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise CommandError(f'-p {printable(rule)}: {printable(repr(text))} is not valid YAML: '
                           'put quotes around a text that has brackets or colons') from error
    # As rcl does: 1e-5 is a number, and null is a text.
    if isinstance(value, str) and isinstance(table.by_name[name].default, float):
        with contextlib.suppress(ValueError):
            value = float(text)
    return name, text if value is None else value
