# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Files of tables hold what was written, and errors are one sentence."""

import csv
import io
import sys

from bahrs_driver.convert import raw, values
from bahrs_driver.errors import TargetExists, WriteError
from bahrs_driver.ros_layout.layouts import LAYOUTS, type_name
from bahrs_driver.ros_layout.message_objects import to_message
from bahrs_driver.tables import row_buffer
from bahrs_driver.tables.memory_sink import MemorySink
from bahrs_driver.tables.table_files import SINKS, table_files
from bahrs_driver.tables.table_writer import TableWriter
from hypothesis import given, HealthCheck, settings, strategies as st
import numpy as np
from pyarrow import parquet
import pytest
from support.flat_messages import flat
from support.layout_values import values_of
from support.targets import no_larger_file_than

TOPICS = {'imu/data': values.Imu, 'fix': values.NavSatFix, '/diagnostics': values.DiagnosticArray,
          'sync_pulse': values.TimeReference}
EVERY = pytest.mark.parametrize('file_format', SINKS)
rows = st.lists(st.sampled_from([topic for topic in TOPICS if topic != 'sync_pulse']).flatmap(
    lambda topic: st.tuples(st.just(topic), st.integers(0, 2 ** 62), values_of(TOPICS[topic]))),
    max_size=8)


def write(writer, messages):
    """Write messages with a writer."""
    writer.begin(TOPICS, set())
    for topic, time_ns, message in messages:
        writer.write([(time_ns, (topic, message))])
    writer.close()


def in_memory(messages):
    """Return the tables of messages."""
    sinks = {topic: MemorySink(kind) for topic, kind in TOPICS.items()}
    write(TableWriter(lambda topic, kind: sinks[topic]), messages)
    return {topic: sink.table() for topic, sink in sinks.items()}


def read_csv(path):
    """Return columns of texts."""
    with path.open(newline='') as file:
        head, *lines = csv.reader(file)
    return {name: [line[index] for line in lines] for index, name in enumerate(head)}


def read_npz(path):
    """Return columns of values."""
    with np.load(path) as archive:
        return {name: archive[name].tolist() for name in archive.files}


def read_parquet(path):
    """Return columns of values."""
    return parquet.read_table(path).to_pydict()


READERS = {'csv': read_csv, 'npz': read_npz, 'parquet': read_parquet}


@EVERY
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(messages=rows, block=st.integers(1, 4))
def test_files_hold_the_tables(tmp_path_factory, monkeypatch, file_format, messages, block):
    """Values and order of columns, whatever the size of blocks; repr() tells all floats apart."""
    folder = tmp_path_factory.mktemp('tables') / 'new'
    with monkeypatch.context() as patch:
        patch.setattr(row_buffer, 'BLOCK_ROWS', block)
        patch.setattr(row_buffer, 'JSON_ROWS', block)
        write(table_files(folder, file_format), messages)
    as_text = str if file_format == 'csv' else repr
    for topic, table in in_memory(messages).items():
        name = topic.strip('/').replace('/', '_')
        found = READERS[file_format](folder / f'{name}.{file_format}')
        assert list(found) == list(table)
        expected = {name: list(map(as_text, column.tolist())) for name, column in table.items()}
        if file_format != 'csv':
            found = {name: list(map(repr, column)) for name, column in found.items()}
        assert found == expected


@given(messages=rows)
@settings(max_examples=30)
def test_csv_text_is_that_of_the_csv_module(tmp_path_factory, messages):
    """Numbers have the shortest text, and texts have quotes where they need them."""
    folder = tmp_path_factory.mktemp('tables') / 'new'
    write(table_files(folder, 'csv'), messages)
    names = [name for name, _ in flat(to_message(values.DiagnosticArray(0, '', ())))]
    expected = csv_line('time_ns', *names) + ''.join(
        csv_line(time_ns, *(value for _, value in flat(to_message(message))))
        for topic, time_ns, message in messages if topic == '/diagnostics')
    assert (folder / 'diagnostics.csv').read_bytes().decode() == expected


def csv_line(*fields):
    """Return a line; before Python 3.13, only this terminator makes it quote both characters."""
    text = io.StringIO()
    csv.writer(text, lineterminator='\r\n').writerow(fields)
    return text.getvalue().removesuffix('\r\n') + '\n'


def test_a_block_is_passed_on_when_it_is_full(monkeypatch):
    """So memory does not depend on the length of a recording."""
    monkeypatch.setattr(row_buffer, 'BLOCK_ROWS', 5)
    monkeypatch.setattr(row_buffer, 'JSON_ROWS', 2)
    sizes = {topic: [] for topic in TOPICS}

    class Sizes:
        def __init__(self, topic, _kind):
            self._sizes = sizes[topic]

        def write(self, block):
            self._sizes.append(len(block['time_ns']))

        def close(self):
            self._sizes.append('end')

    writer = TableWriter(Sizes)
    writer.begin(TOPICS, set())
    message = {'fix': values.position_fix(0, '', None, 0.0, 0.0, 0.0),
               '/diagnostics': values.DiagnosticArray(0, '', ())}
    for number in range(4):
        writer.write([(number, item) for item in message.items()] * 3)
    writer.close()
    assert sizes == {'imu/data': ['end'], 'sync_pulse': ['end'], 'fix': [6, 6, 'end'],
                     '/diagnostics': [3, 3, 3, 3, 'end']}


def test_parquet_metadata(tmp_path):
    """Type and frame stand in the schema, units beside each column; a block is a row group."""
    message = values.TimeReference(1, 'imu_link', 2, 'gps')
    sink = SINKS['parquet'](tmp_path / 'x.parquet', values.TimeReference)
    for count in (2, 3):
        columns = {name: np.repeat(column, count) for name, column in in_memory(
            [('sync_pulse', 1, message)])['sync_pulse'].items()}
        sink.write(columns)
    sink.close()
    file = parquet.ParquetFile(tmp_path / 'x.parquet')
    schema = file.schema_arrow
    assert schema.metadata == {b'message_type': b'sensor_msgs/msg/TimeReference',
                               b'frame_id': b'imu_link'}
    assert schema.field('time_ref.sec').metadata == {b'unit': b's'}
    assert schema.field('source').metadata is None
    assert [file.metadata.row_group(index).num_rows for index in range(2)] == [2, 3]


@pytest.mark.parametrize('kind', LAYOUTS, ids=lambda kind: kind.__name__)
def test_parquet_schema_of_an_empty_table(tmp_path, kind):
    """It is that of a table with rows."""
    SINKS['parquet'](tmp_path / 'x.parquet', kind).close()
    table = parquet.read_table(tmp_path / 'x.parquet')
    assert table.num_rows == 0 and 'time_ns' in table.column_names
    assert table.schema.metadata == {b'message_type': type_name(kind).encode()}


def test_raw_is_only_in_csv_files(tmp_path):
    """The arrays of measurements would not gain from the bytes."""
    for file_format in SINKS:
        writer = table_files(tmp_path / file_format, file_format)
        writer.begin({raw.TOPIC: values.UInt8MultiArray, 'heading': values.Float64}, set())
        writer.write([(1, (raw.TOPIC, raw.message(b'NE', 'label')))])
        writer.close()
        names = {path.stem for path in (tmp_path / file_format).iterdir()}
        assert names == ({'raw', 'heading'} if file_format == 'csv' else {'heading'})
    assert (tmp_path / 'csv' / 'raw.csv').read_text().endswith(',"[78, 69]"\n')


@EVERY
def test_nothing_is_replaced(tmp_path, file_format):
    """Neither the directory nor a file in it."""
    with pytest.raises(TargetExists):
        table_files(tmp_path, file_format)
    writer = table_files(tmp_path / 'new', file_format)
    precious = tmp_path / 'new' / f'fix.{file_format}'
    precious.touch()
    with pytest.raises(TargetExists, match='fix.* exists already'):
        write(writer, [])
    assert precious.read_bytes() == b''


@EVERY
def test_a_file_that_cannot_grow(tmp_path, file_format):
    """The error names the file."""
    writer = table_files(tmp_path / 'new', file_format)
    writer.begin({'heading': values.Float64}, set())
    writer.write([(number, ('heading', values.Float64(number / 7)))
                  for number in range(row_buffer.BLOCK_ROWS - 1)])
    with no_larger_file_than(4000), pytest.raises(
            WriteError, match=f'cannot write .*/heading.{file_format}: File too large'):
        writer.close()


def test_parquet_without_pyarrow(tmp_path, monkeypatch):
    """The sentence has the command that installs it; no file is made."""
    monkeypatch.setitem(sys.modules, 'pyarrow', None)
    with pytest.raises(WriteError, match='pyarrow is not installed: pip install pyarrow'):
        write(table_files(tmp_path / 'new', 'parquet'), [])
    assert list((tmp_path / 'new').iterdir()) == []
