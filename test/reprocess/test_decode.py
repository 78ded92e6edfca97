# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of decoding a stream with a decoder that fails."""

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.pipeline import Notice
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import SyncPulseTime
from bahrs_driver.reprocess.decode import decode_stream
from bahrs_driver.reprocess.decoding_faults import DecodingFaults

FRAMES = [BahrsCodec().encode(SyncPulseTime(i, 1000 * i), 3) for i in range(4)]


def test_a_frame_that_cannot_be_decoded_is_reported(monkeypatch):
    """The others are decoded; the notice has the number of faults and the first frame."""
    decode = BahrsCodec.decode

    def fail(self, frame, now=0):
        message = decode(self, frame, now)
        if message.sequence in (1, 3):
            raise KeyError(message.sequence)
        return message

    monkeypatch.setattr(BahrsCodec, 'decode', fail)
    spec, faults = DEVICES['bahrs'], DecodingFaults()
    decoder = spec.stream_decoder(spec.settings())
    messages = [message for _, message in decode_stream([b''.join(FRAMES)], decoder, faults)]
    assert [message.sequence for message in messages] == [0, 2]
    (sentence,) = faults.notices()
    assert sentence.startswith('2 frames could not be decoded')
    assert f'the first at byte {len(FRAMES[0])} ' in sentence
    assert 'KeyError: 1' in sentence


def test_no_notice_without_a_fault():
    """Notices of a clock are not faults."""
    faults = DecodingFaults()
    assert not list(faults.messages([Notice('set')]))
    assert faults.notices() == []
