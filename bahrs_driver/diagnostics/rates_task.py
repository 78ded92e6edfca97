# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Rates*: whether every message arrives at its rate, and none is lost."""

from collections import Counter
from collections.abc import Mapping

from bahrs_driver.diagnostics.losses import LossCounter, SequenceLosses
from bahrs_driver.diagnostics.rate_monitor import RateMonitor
from bahrs_driver.diagnostics.task import NO_DATA, OK, STALE, Status, Template, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.protocol.message import Message

RATE_SPAN = 2.0             # s over which a rate is measured
LONGEST_GAP = 0.5           # s; a longer time without messages is a pause of the device
SERVICE_TIMEOUT = 6.0       # s after the last request in which diagnostics mode ends

LOST = Template(WARN, 'Lost just now: {counts}', 'lost frames')
WRONG_RATES = Template(WARN, '{rates}', 'a message at a wrong rate')
DIAGNOSTICS_MODE = Template(STALE, 'The device is in diagnostics mode; it leaves by itself 5 s '
                                   'after the last request', 'a device in diagnostics mode')
NOTHING_LOST = Template(OK, 'All messages at their rates')


class RatesTask:
    """
    Counts the received and lost messages of a stream.

    expected is the rate of each message in Hz, by name; 0 accepts any rate. A rate may differ by
    the tolerance, a fraction of it. The stream is stale after stale_timeout seconds without any of
    these messages. Losses are counted by sequence numbers unless another counter is given.
    """

    name = 'Rates'
    messages = LOST, WRONG_RATES, DIAGNOSTICS_MODE, NO_DATA, NOTHING_LOST

    def __init__(self, expected: Mapping[str, float], tolerance: float, stale_timeout: float,
                 losses: LossCounter | None = None) -> None:
        self._expected = expected
        self._stale_timeout = stale_timeout
        self._received = Counter[str]()
        self._losses = losses or SequenceLosses()
        self._measuring = False             # rates, since the first message
        self._last_message: float | None = None
        self._last_service: float | None = None
        self._stream_time = 0.0             # s, without the pauses of the stream
        self._window = Window(self._counts, RATE_SPAN)
        self._rates = RateMonitor(self._counts, list(expected.values()), tolerance, RATE_SPAN)
        self._loss_window = Window(lambda: [self.lost.get(name, 0) for name in expected])

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start, by name."""
        return self._losses.lost

    def observe(self, message: Message, now: float) -> None:
        """Count a message."""
        name = message.NAME
        rate = self._expected.get(name)
        if rate is None:
            if message.SERVICE:
                self._last_service = now
            return
        last, self._last_message = self._last_message, now
        if last is not None:
            self._stream_time += min(now - last, LONGEST_GAP)
            if self._last_service is not None or now - last > self._stale_timeout:
                self._handle_pause(now, last)
        if not self._measuring:
            self._restart_rates()
            self._measuring = True
        self._received[name] += 1
        self._losses.observe(message, self._stream_time, rate)

    def restart(self) -> None:
        """Begin another stream: the device was switched on, or the port opened again."""
        self._losses.restart()
        self._measuring = False
        self._restart_rates()

    def stale(self, now: float) -> bool:
        """Return whether the stream has ended."""
        return self._last_message is None or now - self._last_message > self._stale_timeout

    def run(self, status: Status) -> Status:
        """Report whether the stream flows, complete and at its rates."""
        now = status.now
        status.values_from(self._values)
        if self.stale(now):
            return status.summary(DIAGNOSTICS_MODE if self._in_diagnostics_mode(now) else NO_DATA)
        _, losses = self._loss_window.growth(now)
        self._window.growth(now)
        wrong = self._rates.wrong(now)
        if any(losses):
            return status.summary(LOST, counts=', '.join(
                f'{count} {name}' for name, count in zip(self._expected, losses) if count))
        if wrong:
            expected = list(self._expected.items())
            return status.summary(WRONG_RATES, rates=', '.join(
                f'{expected[index][0]} at {rate:.0f} Hz instead of {expected[index][1]:g}'
                for index, rate in wrong.items()))
        return status.summary(NOTHING_LOST)

    def _values(self, now: float) -> Mapping[str, str]:
        elapsed, counts = self._window.growth(now)
        values = {}
        for (name, rate), count in zip(self._expected.items(), counts):
            measured = count / elapsed if elapsed else 0.0
            values[f'{name} [Hz]'] = f'{measured:.1f}' + (f' of {rate:g}' if rate else '')
            values[f'{name} received'] = str(self._received[name])
            values[f'{name} lost'] = str(self.lost.get(name, 0))
        return values

    def _counts(self) -> list[int]:
        return [self._received[name] for name in self._expected]

    def _handle_pause(self, now: float, last_message: float) -> None:
        if self._last_service is not None and self._last_service > last_message:
            self.restart()              # the device paused for diagnostics mode
        elif now - last_message > self._stale_timeout:
            self._measuring = False     # the pause was reported, and is not a wrong rate

    def _restart_rates(self) -> None:
        self._window.restart()
        self._rates.restart()

    def _in_diagnostics_mode(self, now: float) -> bool:
        return self._last_service is not None \
            and now - self._last_service < self._stale_timeout + SERVICE_TIMEOUT
