# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A finding about a recording, and how times are written in it."""

from enum import Enum
from typing import NamedTuple


class Severity(Enum):
    """Severity of a finding, the worst first."""

    ERROR = 'error'
    WARNING = 'warning'
    NOTICE = 'notice'
    GOOD = 'good'


ERROR, WARNING, NOTICE, GOOD = Severity


class Finding(NamedTuple):
    """A sentence about a recording."""

    severity: Severity
    text: str

    def to_json(self) -> dict[str, str]:
        """Return the finding as plain values."""
        return {'level': self.severity.value, 'text': self.text}


def time_text(seconds: float) -> str:
    """Return a time since the first sample as m:ss.s, or h:mm:ss.s from an hour on."""
    minutes, tenths = divmod(round(seconds * 10), 600)
    if minutes >= 60:
        return f'{minutes // 60}:{minutes % 60:02d}:{tenths / 10:04.1f}'
    return f'{minutes}:{tenths / 10:04.1f}'
