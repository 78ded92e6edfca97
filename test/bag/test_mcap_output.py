# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of writing MCAP files: they have the bytes that the library's own writer makes."""

import io
from itertools import accumulate

from bahrs_driver.bag.mcap_chunk import CHUNK_SIZE
from bahrs_driver.bag.mcap_output import LIBRARY, McapOutput, PROFILE
from bahrs_driver.bag.metadata import FileInformation
from hypothesis import example, given, strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

TOPICS = {'/a': ('x_msgs/msg/X', 'int32 x'), '/b': ('x_msgs/msg/X', 'int32 x'),
          '/c': ('y_msgs/msg/Unknown', '')}
METADATA = {'offered_qos_profiles': '- depth: 1', 'topic_type_hash': 'RIHS01_0'}

# Step of the log time, topic, size of the data; or None for a flush.
STEPS = st.lists(st.none() | st.tuples(
    st.integers(0, 2 ** 50), st.sampled_from([*TOPICS]),
    st.integers(0, 100) | st.sampled_from([CHUNK_SIZE // 3, CHUNK_SIZE + 1])), max_size=30)


def messages_of(steps):
    """Return the messages, and None for each flush."""
    times = accumulate(step[0] if step else 0 for step in steps)
    return [step and (time, step[1], bytes([index]) * step[2], time + index)
            for index, (time, step) in enumerate(zip(times, steps))]


def from_library(messages):
    """Return the file that the writer of the library makes."""
    file, schemas = io.BytesIO(), {}
    writer = Writer(file, CHUNK_SIZE)
    writer.start(PROFILE, LIBRARY)
    numbers, counts = {}, dict.fromkeys(TOPICS, 0)
    for topic, (name, text) in TOPICS.items():
        if name not in schemas:
            schemas[name] = writer.register_schema(name, 'ros2msg' if text else '', text.encode())
        numbers[topic] = writer.register_channel(topic, 'cdr', schemas[name], METADATA)
    for message in messages:
        if message is None:
            writer.flush()
        else:
            log_time, topic, data, publish_time = message
            counts[topic] += 1
            writer.add_message(numbers[topic], log_time, data, publish_time, counts[topic])
    writer.finish()
    return file.getvalue()


def from_output(messages, information, at_once):
    """Return the file that we make."""
    file = io.BytesIO()
    output = McapOutput(file, information)
    for topic, (name, text) in TOPICS.items():
        output.add_topic(topic, name, text, METADATA)
    batch = []
    for message in messages:
        batch += [message] if message else []
        if message is None or len(batch) >= at_once:
            output.write(batch)
            batch = []
        if message is None:
            output.flush()
    output.write(batch)
    output.finish()
    return file.getvalue()


@given(STEPS, st.integers(1, 30))
@example([], 1)
@example([(1, '/a', CHUNK_SIZE)] * 3, 2)
def test_same_bytes_as_from_the_library(steps, at_once):
    """However messages are grouped, chunks, indexes and summary are those of the library."""
    messages = messages_of(steps)
    information = FileInformation('x.mcap')
    assert from_output(messages, information, at_once) == from_library(messages)
    times = [message[0] for message in messages if message]
    assert information.count == len(times)
    if times:
        assert (information.first, information.last) == (times[0], times[-1])


def test_a_message_is_found_by_its_time():
    """The library seeks by the indexes."""
    messages = messages_of([(10, topic, CHUNK_SIZE // 4) for topic in [*TOPICS] * 5])
    reader = make_reader(io.BytesIO(from_output(messages, FileInformation(), 100)))
    found = [(message.log_time, channel.topic, message.data, message.publish_time)
             for _, channel, message in reader.iter_messages(
                 topics=['/b'], start_time=50, end_time=120)]
    assert found == [message for message in messages if message[1] == '/b'
                     and 50 <= message[0] < 120]
    assert len(reader.get_summary().chunk_indexes) > 2
