# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A row of the table: a figure of the driver beside its floor from the same run, and two bounds.

The target is what the project wants to reach; it may be missed. The limit lies above what was
measured when the row was written, by the margin that the machine's noise needs: a row beyond it is
a slowdown of the driver, and fails the run.
"""

from dataclasses import dataclass
from typing import Literal

Quantity = Literal['ours', 'ratio', 'difference']


@dataclass(frozen=True)
class Bound:
    """The largest value of a quantity, or the smallest one."""

    quantity: Quantity
    value: float
    smallest: bool = False


def at_most(quantity: Quantity, value: float) -> Bound:
    """Return the bound of a quantity that should be small."""
    return Bound(quantity, value)


def at_least(quantity: Quantity, value: float) -> Bound:
    """Return the bound of a quantity that should be large."""
    return Bound(quantity, value, smallest=True)


@dataclass(frozen=True)
class Row:
    """
    One figure in a unit, with its floor in the same unit; None if the floor cannot be measured.

    floor_name says what the floor is, note how the figure was made if that differs from the rule.
    """

    what: str
    ours: float
    unit: str
    limit: Bound
    target: Bound | None = None
    floor: float | None = None
    floor_name: str = ''
    note: str = ''

    def quantity(self, name: Quantity) -> float | None:
        """Return a quantity of this row; None if it needs a floor and there is none."""
        if name == 'ours':
            return self.ours
        if self.floor is None:
            return None
        return self.ours - self.floor if name == 'difference' else self.ours / self.floor

    def holds(self, bound: Bound | None) -> bool | None:
        """Return whether a bound holds; None if there is none, or no floor that it needs."""
        if bound is None:
            return None
        value = self.quantity(bound.quantity)
        if value is None:
            return None
        return value >= bound.value if bound.smallest else value <= bound.value

    @property
    def failed(self) -> bool:
        """Return whether the row is beyond its limit."""
        return self.holds(self.limit) is False


@dataclass(frozen=True)
class Fault:
    """A group of rows that could not be measured."""

    group: str
    reason: str


def failures(rows: list[Row], faults: list[Fault]) -> list[str]:
    """Return a sentence for each row beyond its limit and each group without a result."""
    return [f'{row.what}: beyond its limit' for row in rows if row.failed] \
        + [f'{fault.group}: {fault.reason}' for fault in faults]
