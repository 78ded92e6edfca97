# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the messages that count samples: those that are decoded one by one, in their order."""

from bahrs_driver.devices.bahrs.recording_format import make_recording_format
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    Inertial, InertialTime, Navigation, NavigationTime, SoftwareVersion,
)
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.reprocess.counted_messages import CountedMessages
from hypothesis import given, strategies as st
import pytest
from support.emulated import make_emulation, on_the_wire

SAMPLES = Inertial, Navigation
OTHERS = InertialTime, NavigationTime, SoftwareVersion


@pytest.fixture(scope='module')
def stream():
    """Return the bytes of an emulated device from power-on."""
    _, data = on_the_wire(make_emulation(), 3.0)
    return data


def decoded(data):
    """Return offset, type, and counter or message of each message, decoded one by one."""
    framer, codec = Framer(BahrsFormat()), BahrsCodec()
    messages = [(frame.offset, codec.decode(frame))
                for frame in framer.feed(data) + framer.flush()]
    return [(offset, type(message),
             message.sequence if isinstance(message, SAMPLES) else message)
            for offset, message in messages if isinstance(message, SAMPLES + OTHERS)]


def counted(data, size):
    """Return the same from blocks of a size."""
    found, messages = [], CountedMessages(make_recording_format(BahrsSettings(), 'BAHRS'))
    for begin in range(0, len(data), size):
        found += messages.feed(data[begin:begin + size])
    found += messages.flush()
    return [(offset, kind, message.sequence if kind in SAMPLES else message)
            for offset, kind, message in found]


@given(st.lists(st.tuples(st.integers(0, 30_000), st.binary(max_size=3)), max_size=5),
       st.integers(100, 40_000))
def test_as_decoded_one_by_one(stream, damage, size):
    """In blocks of any size, with any bytes in between or in place of others."""
    for place, data in damage:
        stream = stream[:place] + data + stream[place + 1:]
    expected = decoded(stream)
    assert counted(stream, size) == expected and len(expected) > 500
