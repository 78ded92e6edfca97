# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a directory of tables, one file for each topic."""

from collections.abc import Callable
from pathlib import Path

from bahrs_driver.convert import raw
from bahrs_driver.files.new_directory import make_directory
from bahrs_driver.tables.csv_sink import CsvSink
from bahrs_driver.tables.npz_sink import NpzSink
from bahrs_driver.tables.parquet_sink import ParquetSink
from bahrs_driver.tables.table_writer import Sink, TableWriter

# Formats of files, whose names end with them.
SINKS: dict[str, Callable[[Path, type], Sink]] = {
    'csv': CsvSink, 'npz': NpzSink, 'parquet': ParquetSink}
# Arrays of measurements do not repeat the bytes that they were made from.
WITHOUT_RAW = frozenset({raw.TOPIC})


def table_files(folder: Path, file_format: str) -> TableWriter:
    """
    Make the directory, and return the writer of its files; WriteError if that is not possible.

    imu/data becomes imu_data.csv, for example. Only CSV files have the topic `raw`.
    """
    make_directory(folder)

    def open_sink(topic: str, kind: type) -> Sink:
        name = topic.strip('/').replace('/', '_')
        return SINKS[file_format](folder / f'{name}.{file_format}', kind)

    return TableWriter(open_sink, frozenset() if file_format == 'csv' else WITHOUT_RAW)
