# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a table as a numpy archive, with an array for each column."""

from pathlib import Path
from typing import Any

from bahrs_driver.files.guard import guard_new
from bahrs_driver.tables.column import TEXT
from bahrs_driver.tables.memory_sink import MemorySink
import numpy as np


class NpzSink(MemorySink):
    """Collects a table in memory, and writes it when it is complete."""

    def __init__(self, path: Path, kind: type) -> None:
        """Write values of a class to a new file."""
        super().__init__(kind)
        self._path = path

    def close(self) -> None:
        """Write the file; WriteError if that is not possible."""
        table = self.table()
        # Text of fixed width, because arrays of objects need pickle.
        columns: dict[str, Any] = {
            name: column.astype(str) if column.dtype == TEXT else column
            for name, column in table.items()}
        with guard_new(self._path), self._path.open('xb') as file:
            np.savez_compressed(file, **columns)
