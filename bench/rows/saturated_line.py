# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Frames lost from a saturated line beside two busy processes, see `saturation`."""

from collections.abc import Iterator

from harness.row import at_most, Row
from saturation import BUSY, measure as measure_line

BAUD_RATE = 921_600
DURATION = 60.0         # s


def measure() -> Iterator[Row]:
    """Measure once. The floor is the count of frames due, so the ratio is the share lost."""
    writer, subscriber, _ = measure_line(BAUD_RATE, DURATION, BUSY)
    due = writer['sent'] + writer['dropped']
    lost = due - subscriber['received']
    yield Row(f'lost from a line of {BAUD_RATE:,} baud, full for {DURATION:.0f} s, '
              'beside two busy processes', lost, 'frames', at_most('ratio', 0.001),
              at_most('ours', 0), due, 'sent')
