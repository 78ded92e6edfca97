# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A finding about a recording, and how its times are written."""

from typing import NamedTuple

GOOD, NOTICE, WARNING, ERROR = 'good', 'notice', 'warning', 'error'


class Finding(NamedTuple):
    """A sentence, and how much it matters."""

    level: str
    text: str


def clock_time(seconds: float) -> str:
    """Return a time since the beginning as minutes and seconds, or with hours."""
    minutes, tenths = divmod(round(seconds * 10), 600)
    if minutes >= 60:
        return f'{minutes // 60}:{minutes % 60:02d}:{tenths / 10:04.1f}'
    return f'{minutes}:{tenths / 10:04.1f}'
