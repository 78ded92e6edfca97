# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Generated values of messages."""

from typing import Any

from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.rows import Kind, Row
from hypothesis import strategies as st

# ROS strings end at the first zero byte, and are UTF-8, which has no surrogates.
TEXTS = st.text(st.characters(exclude_characters='\0', exclude_categories=['Cs']), max_size=30)
RANGES = {'b': (-2 ** 7, 2 ** 7 - 1), 'B': (0, 2 ** 8 - 1), 'H': (0, 2 ** 16 - 1),
          'I': (0, 2 ** 32 - 1)}


def values_of(kind: type) -> st.SearchStrategy[Any]:
    """Return a strategy for values of a kind."""
    return st.builds(kind, *map(_field, LAYOUTS[kind].rows))


def _field(row: Row) -> st.SearchStrategy[Any]:
    """Return a strategy for the value of a row."""
    if row.kind is Kind.TEXT:
        return TEXTS
    if row.kind is Kind.RECORDS:
        return st.lists(st.tuples(*map(_field, row.rows)), max_size=3).map(tuple)
    if row.kind is Kind.DATA or row.code == 'c':
        return st.binary(min_size=row.code == 'c', max_size=1 if row.code else 30)
    if row.kind is Kind.TIME:
        return st.integers(-2 ** 31 * 10 ** 9, 2 ** 31 * 10 ** 9 - 1)
    one = st.floats() if row.code == 'd' else st.integers(*RANGES[row.code])
    return one if row.kind is Kind.NUMBER else st.tuples(*[one] * row.length)
