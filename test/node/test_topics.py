# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The publishers of a node."""

from bahrs_driver.node.topics import queue_depth
import pytest


@pytest.mark.parametrize(('baud_rate', 'depth'), [(2400, 100), (115_200, 2057), (921_600, 16_457)])
def test_a_queue_holds_five_seconds_of_a_full_line(baud_rate, depth):
    """A reliable subscriber may pause that long without a loss."""
    assert queue_depth(baud_rate) == depth
