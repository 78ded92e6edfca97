# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode bytes into typed messages, with the device time of each where it is known."""

from collections.abc import Iterable, Iterator, Sequence

from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.stream_decoder import AnyDecoder
from bahrs_driver.pipeline import Event, Pipeline
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.reprocess.decoding_faults import DecodingFaults
from bahrs_driver.reprocess.message_times import TimedMessage, with_device_time


def decode(chunks: Iterable[bytes], device: str = DEFAULT,
           settings: CommonSettings | None = None) -> Iterator[TimedMessage]:
    """
    Decode a stream of bytes, cut anywhere, such as a binary file.

    Yield all messages in the order of the stream. device is the value of the parameter `sensor`;
    settings, by default those of the device, are of DEVICES[device].settings. Device time is known
    from the time messages around a message, so that messages are held for up to 0.1 s of the
    stream. Damaged frames and bytes outside frames are skipped.
    """
    spec = DEVICES[device]
    decoder = spec.stream_decoder(settings or spec.settings())
    return with_device_time(decode_stream(chunks, decoder, DecodingFaults()), spec.roles)


def decode_stream(chunks: Iterable[bytes], decoder: AnyDecoder,
                  faults: DecodingFaults) -> Iterator[tuple[Frame, Message]]:
    """Yield the messages of a stream, each as soon as it is complete."""
    kinds = tuple(decoder.kinds)
    for events in _events(chunks, decoder.pipeline):
        for message, frame, _ in faults.messages(events):
            if isinstance(message, kinds):      # not an answer that comes again when decoded
                yield frame, message


def _events(chunks: Iterable[bytes], pipeline: Pipeline) -> Iterator[Sequence[Event]]:
    pipeline.open()
    for chunk in chunks:
        yield pipeline.feed(chunk)
    yield pipeline.close()
