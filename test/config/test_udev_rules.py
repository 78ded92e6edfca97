# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the udev rules: every line is one that udev understands, and what they do."""

from pathlib import Path
import re

from bahrs_driver.doctor.usb_port import DRIVERS, RULE

RULES = Path(__file__).resolve().parents[2] / 'config' / RULE
KEYS = {'ACTION', 'GOTO', 'LABEL', 'SUBSYSTEM', 'SUBSYSTEMS', 'DRIVER', 'ATTR', 'ATTRS', 'ENV',
        'IMPORT', 'GROUP', 'MODE', 'SYMLINK'}
TOKEN = re.compile(r'([A-Z]+)(\{\w+\})?(==|!=|=|\+=)"([^"]*)"')


def rules():
    """Return the tokens (key, attribute, operator, value) of each line."""
    lines = [line for line in RULES.read_text().splitlines() if line and line[0] != '#']
    parsed = [[TOKEN.fullmatch(token) for token in line.split(', ')] for line in lines]
    assert all(all(tokens) for tokens in parsed), parsed
    return [[token.groups() for token in tokens] for tokens in parsed]


def test_every_line_is_understood():
    """Keys are known, and labels that are gone to exist."""
    tokens = [token for line in rules() for token in line]
    assert {key for key, *_ in tokens} <= KEYS
    labels = {value for key, _, _, value in tokens if key == 'LABEL'}
    assert {value for key, _, _, value in tokens if key == 'GOTO'} == labels


def test_what_they_do():
    """Latency, access, ModemManager, a stable name."""
    given = [token for line in rules() for token in line if token[2] in ('=', '+=')]
    assert ('ATTR', '{latency_timer}', '=', '1') in given
    assert ('GROUP', None, '=', 'dialout') in given and ('MODE', None, '=', '0660') in given
    assert given.count(('ENV', '{ID_MM_DEVICE_IGNORE}', '=', '1')) == 2
    assert any(key == 'SYMLINK' for key, *_ in given)


def test_the_doctor_knows_the_same_vendors():
    """What it takes for an adapter is what the rules are for."""
    vendors = [value for line in rules() for key, attribute, _, value in line
               if attribute == '{idVendor}']
    assert vendors and all(set(value.split('|')) == set(DRIVERS) for value in vendors)
