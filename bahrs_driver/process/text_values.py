# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Parse numbers and names that a user typed; ValueError explains the mistake in a sentence."""

from collections.abc import Iterable
import math


def number(text: str, what: str, low: float = 0.0, high: float = math.inf) -> float:
    """Parse a number from low to high."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high or math.isinf(value):
        raise ValueError(f'{what} is {text!r}: it must be a number{_limits(low, high)}')
    return value


def whole(text: str, what: str, low: int, high: int) -> int:
    """Parse a whole number from low to high."""
    value = number(text, what, low, high)
    if value != round(value):
        raise ValueError(f'{what} is {text!r}: it must be a whole number{_limits(low, high)}')
    return round(value)


def known(name: str, what: str, names: Iterable[str]) -> str:
    """Return the name if it is one of some names."""
    if name not in names:
        raise ValueError(f'there is no {what} {name!r}, only {", ".join(names)}')
    return name


def _limits(low: float, high: float) -> str:
    if math.isinf(high):
        return '' if math.isinf(low) else f' of at least {low:.12g}'
    return f' from {low:.12g} to {high:.12g}'
