# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Conversions of captures that are made in memory, and what they write."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.emulator.emulation import SentFrame
from bahrs_driver.reprocess.conversion import Conversion, ConversionResult
from bahrs_driver.reprocess.topic_writer import LoggedValues
from bahrs_driver.ros_layout.message_objects import to_message
from support.emulated import make_device, make_emulation
from support.settings_examples import settings_of

S = 1_000_000_000
ORIGIN = 1_700_000_000 * S


class Kept:
    """An output that keeps all."""

    def __init__(self) -> None:
        """Start with nothing."""
        self.messages: dict[str, list[tuple[int, Any]]] = {}
        self.times: list[int] = []
        self.latched: set[str] = set()

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """Take the topics."""
        self.messages = {topic: [] for topic in topics}
        self.latched = latched

    def prepare(self, messages: Iterable[LoggedValues]) -> Iterable[LoggedValues]:
        """Return messages as they are."""
        return messages

    def write(self, messages: Sequence[LoggedValues]) -> None:
        """Keep messages."""
        for time_ns, (topic, values) in messages:
            self.messages[topic].append((time_ns, to_message(values)))
            self.times.append(time_ns)


class Pieces(Capture):
    """A capture of chunks that are given."""

    timed = True
    byte_ns = 86805

    def __init__(self, chunks: Sequence[Chunk], tmp_path: Path) -> None:
        """Take them."""
        super().__init__(tmp_path, 1)
        self._chunks = chunks

    def chunks(self) -> Iterator[Chunk]:
        """Return them."""
        return iter(self._chunks)


def converted(capture: Capture, start: int | None = None, sensor: str = 'bahrs',
              **changes: object) -> tuple[Kept, ConversionResult]:
    """Convert a capture; return what came and the outcome."""
    settings = settings_of(sensor, **changes).for_recording()
    kept = Kept()
    outcome = Conversion(capture, settings, DEVICES[sensor], start).run(
        kept, lambda what: None)
    return kept, outcome


def stamps(kept: Kept, topic: str = 'imu/data_raw') -> list[int]:
    """Return the stamps of a topic in ns."""
    return [message.header.stamp.sec * S + message.header.stamp.nanosec
            for _, message in kept.messages[topic]]


def flight(seconds: float = 8.0) -> tuple[list[Chunk], list[int]]:
    """Return timed chunks of an emulated device, 16 ms each, and the truth of its samples."""
    emulation = make_emulation(make_device(drift_ppm=40.0), mode=0.016)
    chunks: list[Chunk] = []
    sent: list[SentFrame] = []
    now = 0.0
    while now < seconds:
        now += 0.016
        sent += emulation.advance(now)
        data = emulation.take(now)
        at = round((now + 50e-6) * S)
        if data:
            chunks.append(Chunk(data, ORIGIN + at, 5 * S + at))
    return chunks, [ORIGIN + round(item.emission.time * S) for item in sent
                    if item.emission.name == 'inertial']
