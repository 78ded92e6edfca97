# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Arrival times of bytes, delayed by the line and by a USB adapter.

The line needs ten bit times for a byte. A USB adapter delivers bytes when its latency timer
expires. Some adapters deliver only full packets, several at a time, while bytes keep arriving. A
plain port delivers at once.
"""

from collections import deque
import math

from bahrs_driver.process.text_values import number
from bahrs_driver.units import BITS_PER_BYTE

PACKET_BURST = 8 * 62               # bytes: eight full-speed USB packets, less their status

LONGEST_QUEUE = 0.25                # s of output that may wait for the line; more is lost
IDLE_TIME = 0.016                   # s without bytes before an incomplete packet is sent

_ROUNDING = 1e-6                    # of a byte
AT_ONCE = 'none'
PACKETS = 'packets'


def adapter_mode(text: str) -> str | float:
    """Parse 'none', 'packets', or a latency timer in ms, which is returned in seconds."""
    if text in (AT_ONCE, PACKETS):
        return text
    return number(text, f'a latency timer other than {AT_ONCE} and {PACKETS}', 1, 255) / 1000


class Cable:
    """Delays frames on their way to the host. All times are arguments, in seconds."""

    def __init__(self, baud_rate: int, mode: str | float = AT_ONCE) -> None:
        self.mode = mode
        self.byte_time = BITS_PER_BYTE / baud_rate
        self._line_free = 0.0           # time at which the line has sent everything
        self._sent: deque[tuple[float, bytes]] = deque()    # bytes, with their start on the line

    def send(self, ready: float, data: bytes) -> bool:
        """
        Send data when it is ready and the line is free.

        Return False if the data is lost because the output buffer of the device is full.
        """
        start = ready if ready > self._line_free else self._line_free
        if start > ready + LONGEST_QUEUE:
            return False
        if data:
            self._line_free = start + len(data) * self.byte_time
            self._sent.append((start, data))
        return True

    def unplug(self, now: float) -> None:
        """Unplug the cable: the bytes that have not arrived are lost."""
        self._sent = deque((start, data[:self._count_arrived(start, now)])
                           for start, data in self._sent if self._count_arrived(start, now))
        self._line_free = now

    @property
    def next_time(self) -> float:
        """Time at which take() returns bytes; infinite while the line is idle."""
        if not self._sent:
            return math.inf
        start, data = self._sent[0]
        if self.mode == AT_ONCE:
            return start + len(data) * self.byte_time
        if self.mode == PACKETS:
            return self._burst_time()
        timer = float(self.mode)
        return math.ceil((start + self.byte_time) / timer) * timer

    def take(self, now: float) -> bytes:
        """Return the bytes that the adapter has delivered by now."""
        if self.mode == AT_ONCE:
            return self._take_arrived(now)
        if self.mode != PACKETS:
            timer = float(self.mode)
            return self._take_arrived(math.floor(now / timer + _ROUNDING) * timer)
        data = b''
        while self._sent and (burst := self._burst_time()) <= now:
            data += self._take_arrived(burst)
        return data

    def _burst_time(self) -> float:
        """Return the time at which the next packets are full, or the line has been idle."""
        count, end = 0, math.inf
        for start, data in self._sent:
            if start > end + IDLE_TIME:
                break
            count += len(data)
            end = start + len(data) * self.byte_time
            if count >= PACKET_BURST:
                return end - (count - PACKET_BURST) * self.byte_time
        return end + IDLE_TIME

    def _take_arrived(self, until: float) -> bytes:
        """Remove and return the bytes that have crossed the line by a time."""
        arrived, sent, byte_time = [], self._sent, self.byte_time
        while sent:
            start, data = sent[0]
            if (until - start) / byte_time + _ROUNDING < len(data):
                count = self._count_arrived(start, until)
                if count:
                    arrived.append(data[:count])
                    sent[0] = start + count * byte_time, data[count:]
                break
            arrived.append(data)
            sent.popleft()
        return b''.join(arrived)

    def _count_arrived(self, start: float, now: float) -> int:
        """Return how many bytes of an endless transmission from a start on have arrived."""
        return max(0, math.floor((now - start) / self.byte_time + _ROUNDING))
