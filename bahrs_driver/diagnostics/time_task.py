# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Time*: how stamps are made, and what happened to the clocks."""

from collections.abc import Mapping

from bahrs_driver.clock import Clock, TimeState
from bahrs_driver.diagnostics.task import NO_DATA, OK, STALE, Staleness, Verdict, WARN

LOOK_AGAIN = 0.2        # s
NOTICE_LIFETIME = 5.0   # s that a change is shown
LONG_CHUNK = 60         # bytes a read, from which on an adapter holds them back


class TimeTask:
    """Watches a clock, which only the thread that uses it may look at."""

    name = 'Time'

    def __init__(self, clock: Clock, stale: Staleness) -> None:
        self._clock = clock
        self._stale = stale
        self._state = clock.state()
        self._looked = -LOOK_AGAIN
        self._notice, self._noticed = '', -NOTICE_LIFETIME

    def notice(self, sentence: str, now: float) -> None:
        """Take what happened to the clocks."""
        self._notice, self._noticed = sentence, now

    def update(self, now: float) -> None:
        """Look at the clock, on its thread; not at every read, for that would cost."""
        if now - self._looked >= LOOK_AGAIN:
            self._state, self._looked = self._clock.state(), now

    def judge(self, now: float) -> Verdict:
        """Return how stamps are made at present."""
        state = self._state
        if now - self._noticed < NOTICE_LIFETIME:
            return Verdict(WARN, self._notice)
        if self._stale(now):
            return Verdict(STALE, NO_DATA)
        if state.source == 'arrival':
            return Verdict(OK, 'Stamps are arrival times, as time.source says')
        if state.source == 'exchange' and state.in_use == 'arrival':
            return Verdict(OK, 'Stamps are arrival times: nobody knows when it was asked')
        if state.source == 'exchange':
            return Verdict(OK, 'Stamps are the middle of request and answer, within '
                               f'{state.spread_us / 1000:.1f} ms'
                           if state.settled else 'Nothing answered yet')
        if not state.settled:
            return Verdict(WARN, 'Device time is not known: samples wait for it'
                           if state.held else
                           'Device time is not known: stamps are arrival times')
        if state.source != state.in_use:
            return Verdict(WARN, 'No sync pulses: stamps follow the arrival of samples')
        return Verdict(OK, 'Stamps are device time on ROS time')

    def values(self, now: float) -> Mapping[str, str]:
        """Return what the clock knows."""
        state = self._state
        return {
            'Source': state.source,
            'Source in use': state.in_use,
            **(_exchange(state) if state.source == 'exchange' else _device(state)),
            'Samples stamped with arrival': str(state.arrival_stamps),
            'Host clock set': f'{state.host_steps} times, last by {state.last_host_step_s:.6f} s'
            if state.host_steps else 'never',
            'Median chunk [bytes]': str(state.median_chunk),
            'Advice': _advice(state),
        }


def _exchange(state: TimeState) -> Mapping[str, str]:
    return {'Half a request and its answer, median [us]':
            f'{state.spread_us:.1f}' if state.settled else 'unknown'}


def _device(state: TimeState) -> Mapping[str, str]:
    return {
        'Time messages name': _label(state),
        'ROS time less device time [s]': _known(state.offset_ns, 1e-9, '.6f'),
        'Skew [ppm]': f'{state.skew_ppm:.2f}',
        'Spread [us]': f'{state.spread_us:.1f}',
        'Period [us]': _known(state.period_us, 1.0, '.3f'),
        'Epochs': str(state.epochs),
        'Samples held': str(state.held),
        'Samples dropped': str(state.dropped),
        'Rejected measurements': str(state.rejected_samples),
        'Rejected time messages': str(state.rejected_time_messages),
        'Rejected counters': str(state.rejected_counters),
        'Sync pulses': f'{state.pulses}, spurious {state.pulses_spurious}, '
                       f'missing {state.pulses_missing}',
        'Least delay by pulses [us]': _known(state.pulse_delay_us, 1.0, '.1f'),
    }


def _label(state: TimeState) -> str:
    return {'next': 'the next sample', 'same': 'the sample just sent'}.get(
        state.label, state.label)


def _known(value: float | None, factor: float, precision: str) -> str:
    return 'unknown' if value is None else format(value * factor, precision)


def _advice(state: TimeState) -> str:
    if state.median_chunk <= LONG_CHUNK:
        return 'none'
    return ('the adapter holds bytes back: for lower latency set its timer to 1 ms, '
            'echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB*/latency_timer')
