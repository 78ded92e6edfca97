# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The objects that process one stream of a device.

Parts decode, stamp and convert a live or recorded stream, and need no port. A LivePart writes to
the port of a live stream.
"""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

from bahrs_driver.clock import Clock
from bahrs_driver.convert.outgoing import Outgoing, Values
from bahrs_driver.devices.nvm_reader import NvmReader
from bahrs_driver.diagnostics.stream_health import StreamHealth
from bahrs_driver.diagnostics.task import DiagnosticTask
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.message import Message
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.request_loop import RequestLoop


class Converter(Protocol):
    """Converts device messages to values of `convert.values`, which are published on topics."""

    def convert(self, message: Message, stamp_ns: int) -> Outgoing:
        """Convert a device message to values, each with its topic."""

    def select(self, _topics: Container[str]) -> None:
        """Convert only for these topics from now on; the others have no subscriber."""

    def end_stream(self, _stamp_ns: int) -> Outgoing:
        """Forget the stream, and return values that report its end."""
        return iter(())

    def report_silence(self, _stamp_ns: int) -> Outgoing:
        """Return values that report a pause of the stream."""
        return iter(())


@dataclass(frozen=True)
class LivePart:
    """The objects that write to the port of a device."""

    nvm: NvmReader | None = None            # for devices with a readable memory
    requests: RequestLoop | None = None     # shares the decoder with the thread that reads
    tasks: Sequence[DiagnosticTask] = ()    # diagnostics of the requests


def _no_live_part(_link: Link) -> LivePart:
    return LivePart()


def _no_messages(_message: Message) -> Iterable[tuple[str, Values]]:
    return ()


@dataclass(frozen=True)
class Parts:
    """The objects that decode, stamp, convert and monitor one stream of a device."""

    framer: Framer
    decoder: Decoder
    clock: Clock
    converter: Converter
    health: StreamHealth
    silence_timeout: float                          # s without data before it is reported
    silence_hint: str                               # the remedy for a silent port
    protocol: Callable[[], Mapping[str, str]] = dict        # detected properties, by name
    warnings: Sequence[str] = ()                    # about the settings
    take_notices: Callable[[], list[str]] = list    # about the data, since the last call
    live: Callable[[Link], LivePart] = _no_live_part
    time_label: Literal['auto', 'next', 'same'] = 'auto'    # convention of its time messages
    pulse_topic: str = ''                           # with the times of sync pulses, if any
    # Topics that services of the node publish, regenerated from a recording.
    service_topics: Mapping[str, type] = field(default_factory=dict)
    service_messages: Callable[[Message], Iterable[tuple[str, Values]]] = _no_messages

    def pipeline(self, clock: Clock | None = None) -> Pipeline:
        """Return the pipeline of the stream, by default with the clock of the parts."""
        return Pipeline(self.framer, self.decoder, clock or self.clock)
