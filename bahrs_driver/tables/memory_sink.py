# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Collect a table in memory."""

from collections import defaultdict

from bahrs_driver.ros_layout.layouts import type_name
from bahrs_driver.tables.column import table_columns
from bahrs_driver.tables.row_buffer import Array, Block, compact, is_constant, repeated
from bahrs_driver.tables.table import Table
import numpy as np


class MemorySink:
    """Collects the blocks of one table."""

    def __init__(self, kind: type) -> None:
        """Collect values of a class."""
        self._kind = kind
        self._blocks: dict[str, list[Array]] = defaultdict(list)

    def write(self, block: Block) -> None:
        """Append rows."""
        for name, column in block.items():
            self._blocks[name].append(column)

    def close(self) -> None:
        """Do nothing: table() may be called at any time."""

    def table(self) -> Table:
        """Return all rows. The blocks are freed as the columns are made."""
        columns = table_columns(self._kind)
        made = {column.name: _joined(self._blocks.pop(column.name, []), column.dtype)
                for column in columns}
        return Table(made, type_name(self._kind), {column.name: column.unit for column in columns})


def _joined(blocks: list[Array], dtype: str) -> Array:
    """Return the read-only column that blocks form; one element if that is constant."""
    if not blocks:
        return np.empty(0, dtype)
    if all(map(is_constant, blocks)):
        firsts = compact(np.concatenate([block[:1] for block in blocks]))
        if is_constant(firsts):
            return repeated(firsts, sum(map(len, blocks)))
    column = np.concatenate(blocks)
    column.setflags(write=False)
    return column
