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
from bahrs_driver.reprocess.recording_settings import recording_settings
from bahrs_driver.settings.table import ParameterTable, unknown_parameter
import yaml


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
    return recording_settings(given, sensor, lambda name: f'-p {rule_of[name]}')


def unused_options(options: argparse.Namespace, timed: bool) -> list[str]:
    """Return at most one sentence, about the options without effect."""
    unused = []
    if options.start is not None and timed:
        unused.append('--start (the recording has times)')
    if options.topic is not None and not timed:
        unused.append('--topic (a file of bytes has no topics)')
    if options.namespace and options.kind != 'bag':
        unused.append('--namespace (files are named after topics without it)')
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
