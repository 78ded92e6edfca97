# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Property test: converting a bag with any labels creates a bag or fails with one sentence."""

import functools
from pathlib import Path
import tempfile

from bahrs_driver.bag.read_metadata import END_OF_TIME, ReadMetadata
from bahrs_driver.cli.main import main
from bahrs_driver.convert import raw
from bahrs_driver.ros_layout.layouts import serialize
from hypothesis import given, settings, strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType
from support.bags import write_mcap
from support.emulated import emissions, make_device

READS = 60
ROS, RAW = 1_700_000_000_000_000_000, 5_000_000_000
NUMBER = st.one_of(st.integers(0, 2 ** 63 - 1), st.integers(-3, 3), st.integers(0, 10 ** 9))


@functools.cache
def pieces():
    """Return the bytes of a device, in reads of 16 ms."""
    data = b''.join(item.data for item in emissions(make_device(), READS * 0.016))
    size = len(data) // READS
    return [data[index * size:(index + 1) * size] for index in range(READS)]


@st.composite
def labels(draw):
    """Return a label for each read, some of them with wrong fields or any text."""
    metadata = [ReadMetadata('bahrs', 1, 86805, ROS + index * 16_000_000, RAW + index * 16_000_000)
                for index in range(READS)]
    for place in draw(st.lists(st.integers(0, READS - 1), max_size=8)):
        field = draw(st.sampled_from(ReadMetadata._fields[1:]))
        metadata[place] = metadata[place]._replace(**{field: draw(NUMBER)})
    if draw(st.booleans()):         # from some read on, as if the host was restarted
        place, by = draw(st.integers(0, READS)), draw(st.integers(-RAW, END_OF_TIME))
        field = draw(st.sampled_from(('ros_ns', 'raw_ns')))
        metadata[place:] = [item._replace(**{field: getattr(item, field) + by})
                            for item in metadata[place:]]
    words = [item.to_label() for item in metadata]
    for place in draw(st.lists(st.integers(0, READS - 1), max_size=3)):
        words[place] = draw(st.text(st.characters(exclude_categories=['Cs']), max_size=30))
    return words


@settings(max_examples=40)
@given(labels=labels(), log_time=st.integers(0, 2 ** 64 - 1),
       lost=st.sets(st.integers(0, READS - 1), max_size=5))
def test_labels_of_any_kind(labels, log_time, lost):
    """Log times never decrease, and errors have no traceback."""
    items = [(log_time, serialize(raw.message(data, label)))
             for index, (data, label) in enumerate(zip(pieces(), labels)) if index not in lost]
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / 'bag.mcap', Path(folder) / 'out'
        write_mcap(source, CompressionType.NONE, 1 << 20, items)
        status = main(['convert', str(source), str(target)])
        assert status == (0 if target.exists() else 1)
        if target.exists():
            with (target / 'out_0.mcap').open('rb') as file:
                times = [message.log_time for *_, message in make_reader(file).iter_messages(
                    log_time_order=False)]
            assert times and times == sorted(times)
