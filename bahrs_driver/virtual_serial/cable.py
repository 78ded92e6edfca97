# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
When bytes arrive: the line that takes ten bits for each, and the adapter that holds them back.

A USB adapter hands bytes over when its latency timer runs out. Some never do so while bytes
keep coming, and hand over full packets only, several at a time. A plain port gives them at once.
"""

from collections import deque
import math

from bahrs_driver.process.text_values import number
from bahrs_driver.units import BITS_PER_BYTE

PACKET_BURST = 8 * 62               # bytes: eight full-speed USB packets, less their status

LONGEST_QUEUE = 0.25                # s of output that wait for the line before some is lost
IDLE_TIME = 0.016                   # s, after which even a packet that is not full is sent

_ROUNDING = 1e-6                    # of a byte
AT_ONCE = 'none'
PACKETS = 'packets'


def adapter_mode(text: str) -> str | float:
    """Return 'none', 'packets', or the latency timer in seconds; ValueError otherwise."""
    if text in (AT_ONCE, PACKETS):
        return text
    return number(text, f'a latency timer other than {AT_ONCE} and {PACKETS}', 1, 255) / 1000


class Cable:
    """Takes frames when they are ready and gives out bytes when they arrive. No clock."""

    def __init__(self, baud_rate: int, mode: str | float = AT_ONCE) -> None:
        self.mode = mode
        self.byte_time = BITS_PER_BYTE / baud_rate
        self._free = 0.0                # when the line has sent all it was given
        self._pieces: deque[tuple[float, bytes]] = deque()      # begin on the line, bytes

    def send(self, ready: float, data: bytes) -> bool:
        """
        Put data on the line as soon as it is ready and the line is free.

        False if so much is waiting already that a device has no room for more.
        """
        start = max(ready, self._free)
        if start > ready + LONGEST_QUEUE:
            return False
        if data:
            self._free = start + len(data) * self.byte_time
            self._pieces.append((start, data))
        return True

    def cut(self, now: float) -> None:
        """Lose what has not arrived by now, as pulling the plug does."""
        self._pieces = deque((start, data[:self._arrived(start, now)])
                             for start, data in self._pieces if self._arrived(start, now))
        self._free = now

    @property
    def next_time(self) -> float:
        """When there is something to take; infinite while nothing is on the line."""
        if not self._pieces:
            return math.inf
        start, data = self._pieces[0]
        if self.mode == AT_ONCE:
            return start + len(data) * self.byte_time
        if self.mode == PACKETS:
            return self._burst_time()
        timer = float(self.mode)
        return math.ceil((start + self.byte_time) / timer) * timer

    def take(self, now: float) -> bytes:
        """Return the bytes that the adapter has handed over by now."""
        if self.mode == AT_ONCE:
            return self._take_arrived(now)
        if self.mode != PACKETS:
            timer = float(self.mode)
            return self._take_arrived(math.floor(now / timer + _ROUNDING) * timer)
        data = b''
        while self._pieces and (burst := self._burst_time()) <= now:
            data += self._take_arrived(burst)
        return data

    def _burst_time(self) -> float:
        """Return when the next packets are full, or nothing has come for a while."""
        count, end = 0, math.inf
        for start, data in self._pieces:
            if start > end + IDLE_TIME:
                break
            count += len(data)
            end = start + len(data) * self.byte_time
            if count >= PACKET_BURST:
                return end - (count - PACKET_BURST) * self.byte_time
        return end + IDLE_TIME

    def _take_arrived(self, until: float) -> bytes:
        arrived = []
        while self._pieces:
            start, data = self._pieces[0]
            count = self._arrived(start, until)
            if count < len(data):
                if count:
                    arrived.append(data[:count])
                    self._pieces[0] = start + count * self.byte_time, data[count:]
                break
            arrived.append(data)
            self._pieces.popleft()
        return b''.join(arrived)

    def _arrived(self, start: float, now: float) -> int:
        """Return how many of the bytes that began at a time have arrived, as if without end."""
        return max(0, math.floor((now - start) / self.byte_time + _ROUNDING))
