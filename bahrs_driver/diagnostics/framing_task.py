# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Framing*: whether the bytes form intact frames."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, OK, STALE, Status, Template, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.pipeline import PipelineCounters
from bahrs_driver.protocol.framing import FramingCounters

ENOUGH_BYTES = 200          # without a frame among them, from which on it is an error
TEXT_SHARE = 0.95           # of printable bytes, from which on a stream is text
EXAMINE_PERIOD = 1.0        # s from one examination of the bytes to the next
HYSTERESIS = 0.8            # of error_share, below which an unusable line is usable again

NOTHING_RECEIVED = Template(STALE, 'Nothing received')
INCOMPLETE = Template(STALE, 'Waiting for a whole frame')
NO_FRAME = Template(ERROR, 'Bytes arrive, but no frame of a {sensor}: is {baud_rate} the baud '
                           'rate of the device, and is it a {sensor}?', 'wrong baud rate')
TEXT = Template(ERROR, 'Text arrives, but no frame of a {sensor}: another device is on this port',
                'another device that sends text')
OTHER_SENSOR = Template(ERROR, 'A {found} is on this port, not a {sensor}: set parameter sensor '
                               'to it', 'the other sensor')
UNKNOWN_TYPES = Template(ERROR, 'Only frames of unknown type arrive: is the {sensor} newer than '
                                'this driver?',
                         'a protocol version that this driver does not know')
UNUSABLE = Template(ERROR, '{share:.0%} of the frames are damaged: check cable, ground and baud '
                           'rate', 'a bad cable')
DAMAGED = Template(WARN, 'Just now: damaged frames {failures}, stray bytes {skipped}',
                   'a frame damaged now and then')
INTACT = Template(OK, 'All frames intact')


class FramingTask:
    """
    Watches the counters of a pipeline.

    protocol returns detected properties of the device's protocol, recognize the name of the device
    whose frames some bytes contain. Above error_share of damaged frames the line is unusable; any
    damaged frame is a warning.
    """

    name = 'Framing'
    messages = (NO_FRAME, TEXT, OTHER_SENSOR, UNKNOWN_TYPES, UNUSABLE, DAMAGED, NOTHING_RECEIVED,
                INCOMPLETE, INTACT)

    def __init__(self, counters: PipelineCounters, baud_rate: int, sensor: str,
                 protocol: Callable[[], Mapping[str, str]],
                 recognize: Callable[[bytes], str], error_share: float) -> None:
        self._counters = counters
        self._baud_rate = baud_rate
        self._sensor = sensor
        self._protocol = protocol
        self._recognize = recognize
        self._error_share = error_share
        self._unusable = False
        self._last_frame = (0, 0), 0    # frames, by opening of the port, and bytes up to it
        self._examined_at = -EXAMINE_PERIOD
        self._reason: tuple[Template, dict[str, object]] = INCOMPLETE, {}
        self._window = Window(self._counts)

    def run(self, status: Status) -> Status:
        """Report how many frames of the last second are intact."""
        status.values_from(self._values)
        _, (received, frames, unknown, failures, skipped) = self._window.growth(status.now)
        bytes_without_frame = self._bytes_without_frame()
        if not received:
            return status.summary(NOTHING_RECEIVED)
        if not frames:
            if bytes_without_frame < ENOUGH_BYTES:
                return status.summary(INCOMPLETE)
            message, fields = self._why_no_frames(status.now)
            return status.summary(message, **fields)
        if frames == unknown:
            return status.summary(UNKNOWN_TYPES, sensor=self._sensor)
        share = failures / (failures + frames)
        # Without hysteresis, a share at the limit would change the level at every frame.
        self._unusable = share > self._error_share * (HYSTERESIS if self._unusable else 1.0)
        if self._unusable:
            return status.summary(UNUSABLE, share=share)
        if failures or skipped:
            return status.summary(DAMAGED, failures=failures, skipped=skipped)
        return status.summary(INTACT)

    def _values(self, _now: float) -> Mapping[str, str]:
        framing = self._counters.framing
        return {
            **self._protocol(),
            'Frames': str(framing.frames),
            'CRC failures': str(framing.crc_failures),
            'Skipped bytes': str(framing.skipped_bytes),
            'Frames of unknown type': _unknown_types(framing),
        }

    def _counts(self) -> tuple[int, int, int, int, int]:
        framing = self._counters.framing
        unknown = framing.unknown_types.total()
        return (self._counters.bytes_received, framing.frames + unknown, unknown,
                framing.crc_failures, framing.skipped_bytes)

    def _bytes_without_frame(self) -> int:
        # Over any time: a wrong device may send a few bytes a second only.
        received, frames, *_ = self._counts()
        count = frames, self._counters.streams
        if count != self._last_frame[0]:
            self._last_frame = count, received
        return received - self._last_frame[1]

    def _why_no_frames(self, now: float) -> tuple[Template, dict[str, object]]:
        if now - self._examined_at >= EXAMINE_PERIOD:
            self._examined_at, self._reason = now, self._examine_bytes()
        return self._reason

    def _examine_bytes(self) -> tuple[Template, dict[str, object]]:
        sample = self._counters.last_bytes
        found = self._recognize(sample)
        if found and found != self._sensor:
            return OTHER_SENSOR, {'found': found, 'sensor': self._sensor}
        text = sum(byte in b'\r\n\t' or 0x20 <= byte < 0x7F for byte in sample)
        if text > TEXT_SHARE * len(sample):
            return TEXT, {'sensor': self._sensor}
        return NO_FRAME, {'sensor': self._sensor, 'baud_rate': self._baud_rate}


def _unknown_types(framing: FramingCounters) -> str:
    counts = sorted(framing.unknown_types.items())
    return ', '.join(f'{name}: {count}' for name, count in counts) or 'none'
