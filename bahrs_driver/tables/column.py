# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The columns of the table of a topic.

The name of a column is the path of its field in the message; elements of an array are numbered
from 0. The column time_ns, the log time of the message in a bag, stands before them.
"""

from collections.abc import Iterator
from typing import NamedTuple

from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.rows import Kind, Row

TIME = 'time_ns'
TEXT = 'O'          # a numpy object array of str


class Column(NamedTuple):
    """A column; dtype is the character code of numpy, TEXT for a string."""

    name: str
    dtype: str
    unit: str = ''


def table_columns(kind: type) -> list[Column]:
    """Return the columns for a class of values."""
    return [Column(TIME, 'q', 'ns'),
            *(column for row in LAYOUTS[kind].rows for column in row_columns(row))]


def row_columns(row: Row) -> Iterator[Column]:
    """Yield the columns that a row of a layout becomes."""
    if row.kind is Kind.TIME:
        yield Column(f'{row.path}.sec', 'i', 's')
        yield Column(f'{row.path}.nanosec', 'I', 'ns')
    elif row.kind is Kind.NUMBERS:
        yield from (Column(f'{row.path}.{name}', row.code, row.unit)
                    for name in row.members or range(row.length))
    elif row.kind is Kind.NUMBER:
        yield Column(row.path, row.code, row.unit)
    else:
        yield Column(row.path, TEXT)
