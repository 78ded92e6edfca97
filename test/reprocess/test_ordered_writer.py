# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of writing messages in the order of their log times."""

from bahrs_driver.reprocess.ordered_writer import LONGEST_DELAY, OrderedWriter, WRITTEN_AT_ONCE


class Writer:
    """Keeps the log times of what is written, one list for each call."""

    def __init__(self):
        self.calls = []

    def prepare(self, messages):
        """Return messages as they are."""
        return messages

    def write(self, messages):
        """Keep log times."""
        self.calls.append([time_ns for time_ns, _ in messages])


def test_messages_are_written_in_order_and_counted():
    """In the end, even a few."""
    writer = Writer()
    output = OrderedWriter(writer)
    output.add((time_ns, 'message') for time_ns in (3, 1, 2))
    output.write_until(LONGEST_DELAY + 3)
    assert not writer.calls
    output.write_all()
    assert writer.calls == [[1, 2, 3]]
    assert (output.count, output.first_ns, output.last_ns) == (3, 1, 3)


def test_many_messages_are_written_up_to_the_longest_delay():
    """The first log time stays, even if it is 0, as device time may be."""
    writer = Writer()
    output = OrderedWriter(writer)
    output.add((time_ns, 'message') for time_ns in range(WRITTEN_AT_ONCE))
    output.write_until(LONGEST_DELAY + 9)
    assert writer.calls == [list(range(10))]
    output.write_all()
    assert (output.count, output.first_ns) == (WRITTEN_AT_ONCE, 0)
    assert output.last_ns == WRITTEN_AT_ONCE - 1
