# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of the driver for a conversion, from the options -p NAME:=VALUE."""

import argparse
from collections.abc import Mapping, Sequence
import contextlib
from typing import Any

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.settings.table import BY_NAME, defaults
from bahrs_driver.settings.unused import unknown_parameter, unused_parameters
import yaml

# Names, and beginnings of names, of what only a driver with a port has.
LIVE_ONLY = ('port', 'publish.raw', 'nvm.', 'startup.', 'diagnostics.qualified_name')


def read_settings(rules: Sequence[str], sensor: str) -> tuple[Mapping[str, Any], list[str]]:
    """
    Return the values of all parameters, and sentences about rules that change nothing.

    CommandError and ParameterError say what is wrong with a rule.
    """
    fixed = {'sensor': sensor, **DEVICES[sensor].recorded_settings}
    settings = {**defaults(), **fixed}
    given: dict[str, Any] = {}
    notes: list[str] = []
    for rule in rules:
        name, value = _parse(rule)
        parameter = BY_NAME[name]
        settings[name] = parameter.convert(value)
        if name in fixed and settings[name] != fixed[name]:
            raise CommandError(f'-p {printable(rule)}: ' + (
                f'write --sensor {settings[name]} instead' if name == 'sensor' else
                'it can only be 0, for nothing is asked of what was recorded'))
        given[name] = value
        notes += filter(None, [parameter.correction(value)])
    unused = [*unused_parameters(given, settings),
              *(f'{name} (it is for a port)' for name in given if name.startswith(LIVE_ONLY))]
    if unused:
        notes.append(f'settings without effect: {"; ".join(unused)}')
    return settings, notes


def unused_options(options: argparse.Namespace, timed: bool) -> list[str]:
    """Return a sentence if there are options without effect on a recording with times or not."""
    unused = []
    if options.start is not None and timed:
        unused.append('--start (the recording has times)')
    if options.topic is not None and not timed:
        unused.append('--topic (a file of bytes has no topics)')
    if options.namespace and options.kind == 'csv':
        unused.append('--namespace (CSV files are named after topics without it)')
    return [f'options without effect: {"; ".join(unused)}'] if unused else []


def _parse(rule: str) -> tuple[str, Any]:
    """Return the name and the value of a rule; CommandError if it is none."""
    name, _, text = rule.partition(':=')
    if not name or not text:
        raise CommandError(f'-p {printable(rule)}: it must be NAME:=VALUE, of a parameter of the '
                           'driver')
    if name not in BY_NAME:
        raise CommandError(f'-p {printable(rule)}: {unknown_parameter(name, list(BY_NAME))}')
    try:
        value = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise CommandError(f'-p {printable(rule)}: {printable(repr(text))} is no value of YAML: '
                           'put quotes around a text that has brackets or colons') from error
    # As rcl reads it: 1e-5 is a number, and nothing but [] is no value.
    if isinstance(value, str) and isinstance(BY_NAME[name].default, float):
        with contextlib.suppress(ValueError):
            value = float(text)
    return name, text if value is None else value
