# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find values that are complete: none of their numbers is NaN.

NaN means that a component is not reported. A filter with a state, such as most orientation
filters, never recovers from a NaN, so its user may have incomplete messages withheld. NavSatFix is
not checked: the altitude of `pressure_altitude` has no latitude and longitude, and the status of a
`fix` shows whether it has a position.
"""

from collections.abc import Iterator
from math import isnan

from bahrs_driver.convert.outgoing import Outgoing, Values
from bahrs_driver.convert.values import DiagnosticArray, NavSatFix, TFMessage

_NOT_CHECKED = NavSatFix, DiagnosticArray, TFMessage


def complete(values: Values) -> bool:
    """Return whether no number is NaN."""
    return isinstance(values, _NOT_CHECKED) or not any(map(isnan, _numbers(values)))


def without_incomplete(outgoing: Outgoing) -> Outgoing:
    """Yield the topics and values that are complete."""
    return (pair for pair in outgoing if complete(pair[1]))


def _numbers(values: Values) -> Iterator[float]:
    for value in values:
        if isinstance(value, float):
            yield value
        elif isinstance(value, tuple):
            yield from value
