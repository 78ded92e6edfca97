# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""When the bytes of a recorded stream are due."""

from bahrs_driver.emulator.pacing import paced
from emulated import emissions, make_device
import pytest


def test_an_emulated_stream_gets_its_own_times_back():
    """Nothing is left out, and each sample is 5 ms after the one before."""
    sent = emissions(make_device(), 3.0)
    data = b''.join(emission.data for emission in sent)
    pieces = list(paced(data))
    assert b''.join(piece for _, piece in pieces) == data
    assert [due for due, _ in pieces] == pytest.approx([0.005 * index
                                                        for index in range(len(pieces))])
    assert pieces[-1][0] == pytest.approx(2.4, abs=0.011)


def test_what_is_no_stream_is_due_at_once():
    """In one piece."""
    assert list(paced(b'nothing in here')) == [(0.0, b'nothing in here')]
    assert list(paced(b'')) == [(0.0, b'')]
