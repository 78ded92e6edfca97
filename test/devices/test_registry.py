# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the registry of devices."""

import random

from bahrs_driver.devices.registry import recognize
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import NavigationTime
from bahrs_driver.protocol.titan_m.frames import build_answer
from bahrs_driver.protocol.titan_m.messages import State
import pytest

NOISE = random.Random(4).randbytes(60)
BAHRS = BahrsCodec().encode(NavigationTime(1, 2, 3), 3)
TITAN_M = build_answer(State(*[(0.0,) * 3] * 4))


@pytest.mark.parametrize('data, name', [
    (NOISE + BAHRS + NOISE, 'bahrs'),
    (NOISE + TITAN_M + NOISE, 'titan_m'),
    (BAHRS[7:], ''),
    (NOISE, ''),
    (b'', ''),
])
def test_one_whole_frame_identifies_a_device(data, name):
    """The frame may stand anywhere; a part of a frame identifies none."""
    assert recognize(data) == name
