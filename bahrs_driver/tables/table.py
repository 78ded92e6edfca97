# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The table of a topic in memory."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Table(dict[str, NDArray[Any]]):
    """
    The messages of one topic: one-dimensional arrays of equal length, by the name of the column.

    It is a dict, which pandas.DataFrame(table), polars.DataFrame(table) and pyarrow.table(table)
    accept. The columns are, in this order:

    - time_ns: log time in ns (int64). It never decreases; it is the stamp without the steps of the
      host's clock
    - header.stamp.sec and header.stamp.nanosec: stamp (int32, uint32); header.frame_id: frame in
      which vectors are given (str). A message without a header has none of them
    - all other fields of the message by their paths, such as angular_velocity.x; elements of an
      array are numbered, as orientation_covariance.0 to .8, row by row. Sequences are JSON texts

    A number that is not reported is NaN, as in the message. Arrays are read-only: a constant
    column has only one element in memory. Copy one to change it.
    """

    def __init__(self, columns: Mapping[str, NDArray[Any]], message_type: str,
                 units: Mapping[str, str]) -> None:
        super().__init__(columns)
        self.message_type = message_type        # such as sensor_msgs/msg/Imu
        self.units = units                      # by column; empty where there is none

    def __repr__(self) -> str:
        return f'<table of {self.message_type}: {self.rows:,} rows, {len(self)} columns>'

    @property
    def rows(self) -> int:
        """Messages, and thus the length of each column."""
        return len(self['time_ns'])

    def stack(self, path: str) -> NDArray[np.float64]:
        """
        Return the members of a vector, a quaternion or an array as one array (rows, members).

        Members are in the order of the message: x, y, z for angular_velocity, x, y, z, w for
        orientation, 9 or 36 elements for a covariance. KeyError if there is no such field.
        """
        members = [column for name, column in self.items()
                   if name.rpartition('.')[0] == path and column.dtype == np.float64]
        if not members:
            raise KeyError(path)
        return np.stack(members, axis=1)


class Tables(dict[str, Table]):
    """
    The tables of all topics of a recording, by the topic's name.

    notes has a sentence for each thing that the user should know, such as damaged parts of the
    recording, which are left out.
    """

    def __init__(self, tables: Mapping[str, Table], notes: list[str]) -> None:
        super().__init__(tables)
        self.notes = notes
