# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Framing*: whether the bytes form intact frames."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, OK, STALE, Status, Template, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.pipeline import PipelineCounters
from bahrs_driver.protocol.framing import FramingCounters

MAX_BYTES_WITHOUT_FRAME = 200   # more are an error
MIN_TEXT_SHARE = 0.95           # share of printable bytes in a stream of text
EXAMINE_PERIOD = 1.0            # s from one examination of the bytes to the next
HYSTERESIS = 0.8                # factor on error_share below which a line is usable again

NOTHING_RECEIVED = Template(STALE, 'Nothing received')
INCOMPLETE = Template(STALE, 'Waiting for a whole frame')
NO_FRAME = Template(ERROR, 'Bytes arrive, but no frame of a {sensor}: is {baud_rate} the baud '
                           'rate of the device, and is it a {sensor}?', 'wrong baud rate')
TEXT = Template(ERROR, 'Text arrives, but no frame of a {sensor}: another device is on this port',
                'another device that sends text')
OTHER_SENSOR = Template(ERROR, 'A {found} is on this port, not a {sensor}: set parameter sensor '
                               'to {found}', 'the other sensor')
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

    protocol returns detected properties of the device's protocol; recognize returns the name of
    the device whose frames some bytes contain. A share of damaged frames above error_share is an
    error, any other damaged frame a warning.
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
        self._frames_and_streams = 0, 0     # when the last frame arrived or the port was opened
        self._bytes_before = 0              # that time
        self._examined_at = -EXAMINE_PERIOD
        self._recognized = ''
        self._no_frame_reason = INCOMPLETE
        self._window = Window(self._counts)

    def run(self, status: Status) -> Status:
        """Report how many frames of the last second are intact."""
        status.values_from(self._values)
        _, (received, frames, unknown, failures, skipped) = self._window.growth(status.now)
        bytes_without_frame = self._bytes_without_frame()
        if not received:
            return status.summary(NOTHING_RECEIVED)
        if not frames:
            if bytes_without_frame < MAX_BYTES_WITHOUT_FRAME:
                return status.summary(INCOMPLETE)
            self._examine_bytes(status.now)
            return status.summary(self._no_frame_reason, sensor=self._sensor,
                                  baud_rate=self._baud_rate, found=self._recognized)
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
        """Return the bytes since the last frame, however long ago: a device may send few."""
        received, frames, *_ = self._counts()
        frames_and_streams = frames, self._counters.streams
        if frames_and_streams != self._frames_and_streams:
            self._frames_and_streams, self._bytes_before = frames_and_streams, received
        return received - self._bytes_before

    def _examine_bytes(self, now: float) -> None:
        """Find the reason why the bytes form no frames, once per EXAMINE_PERIOD."""
        if now - self._examined_at < EXAMINE_PERIOD:
            return
        self._examined_at = now
        sample = self._counters.last_bytes
        self._recognized = self._recognize(sample)
        if self._recognized not in ('', self._sensor):
            self._no_frame_reason = OTHER_SENSOR
        else:
            self._no_frame_reason = TEXT if _is_text(sample) else NO_FRAME


def _is_text(sample: bytes) -> bool:
    printable = sum(byte in b'\r\n\t' or 0x20 <= byte < 0x7F for byte in sample)
    return printable > MIN_TEXT_SHARE * len(sample)


def _unknown_types(framing: FramingCounters) -> str:
    counts = sorted(framing.unknown_types.items())
    return ', '.join(f'{name}: {count}' for name, count in counts) or 'none'
