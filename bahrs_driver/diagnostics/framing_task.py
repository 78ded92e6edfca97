# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Framing*: whether the bytes are frames, and the frames intact."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, OK, STALE, Verdict, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.protocol.framing import Framer, FramingCounters
from bahrs_driver.transport.receiver import LinkCounters

ENOUGH_BYTES = 200          # without a frame among them to say that something is wrong
TEXT_SHARE = 0.95           # of printable bytes, from which on a stream is text
LOOK_AGAIN = 1.0            # s, for looking at bytes has its price
RELIEF = 0.8                # of the share from which on a line is unusable: below, it is again


class FramingTask:
    """Watches what the framer makes of the bytes."""

    name = 'Framing'

    def __init__(self, framer: Framer, counters: LinkCounters, baud_rate: int, sensor: str,
                 protocol: Callable[[], Mapping[str, str]],
                 recognize: Callable[[bytes], str], error_share: float) -> None:
        """
        Watch a framer.

        protocol returns detected properties of the device's protocol, recognize the name of the
        device whose frames some bytes contain. Above error_share of damaged frames the line is
        unusable; any damaged frame is a warning.
        """
        self._framer = framer
        self._counters = counters
        self._baud_rate = baud_rate
        self._sensor = sensor
        self._protocol = protocol
        self._recognize = recognize
        self._error_share = error_share
        self._unusable = False
        self._last_frame = (0, 0), 0    # frames, by opening of the port, and bytes up to it
        self._reason = -LOOK_AGAIN, ''
        self._window = Window(self._counts)

    def _counts(self) -> tuple[int, int, int, int, int]:
        framing = self._framer.counters
        strangers = framing.unknown_types.total()
        return (self._counters.bytes_received, framing.frames + strangers, strangers,
                framing.crc_failures, framing.skipped_bytes)

    def judge(self, now: float) -> Verdict:
        """Return how the last second went."""
        _, (received, frames, strangers, failures, skipped) = self._window.growth(now)
        fruitless = self._bytes_without_frame()
        if not received:
            return Verdict(STALE, 'Nothing received')
        if not frames:
            if fruitless < ENOUGH_BYTES:
                return Verdict(STALE, 'Waiting for a whole frame')
            return Verdict(ERROR, self._why_no_frames(now))
        if frames == strangers:
            return Verdict(ERROR, f'Only frames of unknown type arrive: is the {self._sensor} '
                                  'newer than this driver?')
        share = failures / (failures + frames)
        # Or else a share at the limit would be another level at every frame.
        self._unusable = share > self._error_share * (RELIEF if self._unusable else 1.0)
        if self._unusable:
            return Verdict(ERROR, f'{share:.0%} of the frames are damaged: check cable, ground '
                                  'and baud rate')
        if failures or skipped:
            return Verdict(WARN, f'Just now: damaged frames {failures}, stray bytes {skipped}')
        return Verdict(OK, 'All frames intact')

    def values(self, now: float) -> Mapping[str, str]:
        """Return what was detected, and what was counted since the start."""
        framing = self._framer.counters
        return {
            **self._protocol(),
            'Frames': str(framing.frames),
            'CRC failures': str(framing.crc_failures),
            'Skipped bytes': str(framing.skipped_bytes),
            'Frames of unknown type': _unknown_types(framing),
        }

    def _bytes_without_frame(self) -> int:
        # Since whenever: a device that says little is as wrong as one that says much.
        received, frames, *_ = self._counts()
        count = frames, self._counters.times_opened
        if count != self._last_frame[0]:
            self._last_frame = count, received
        return received - self._last_frame[1]

    def _why_no_frames(self, now: float) -> str:
        if now - self._reason[0] >= LOOK_AGAIN:
            self._reason = now, self._look_at_bytes()
        return self._reason[1]

    def _look_at_bytes(self) -> str:
        sample = self._counters.last_bytes
        other = self._recognize(sample)
        if other and other != self._sensor:
            return f'A {other} is on this port, not a {self._sensor}: set parameter sensor to it'
        text = sum(byte in b'\r\n\t' or 0x20 <= byte < 0x7F for byte in sample)
        if text > TEXT_SHARE * len(sample):
            return (f'Text arrives, but no frame of a {self._sensor}: another device is on this '
                    'port')
        return (f'Bytes arrive, but no frame of a {self._sensor}: is {self._baud_rate} the baud '
                f'rate of the device, and is it a {self._sensor}?')


def _unknown_types(framing: FramingCounters) -> str:
    counts = sorted(framing.unknown_types.items())
    return ', '.join(f'{name}: {count}' for name, count in counts) or 'none'
