# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Time*: how stamps are made, and events of the clocks."""

from collections.abc import Mapping

from bahrs_driver.clock import Clock, TimeState
from bahrs_driver.diagnostics.task import NO_DATA, OK, Staleness, Status, Template, WARN

UPDATE_PERIOD = 0.2     # s
NOTICE_LIFETIME = 5.0   # s for which an event is shown
LONG_CHUNK = 60         # bytes per read; in longer ones, the adapter holds bytes back

EVENT = Template(WARN, '{event}', 'a host clock that was set, or a device that restarted')
UNKNOWN_HELD = Template(WARN, 'Device time is not known: samples wait for it')
UNKNOWN = Template(WARN, 'Device time is not known: stamps are arrival times',
                   'no time message yet')
NO_PULSES = Template(WARN, 'No sync pulses: stamps follow the arrival of samples',
                     'sync pulses missing')
ARRIVAL = Template(OK, 'Stamps are arrival times, as time.source says')
REQUESTS_UNKNOWN = Template(
    OK, 'Stamps are arrival times: the times of the requests are not known')
NO_ANSWER_YET = Template(OK, 'Nothing answered yet')
EXCHANGE = Template(OK, 'Stamps are the middle of request and answer, within {spread_ms:.1f} ms')
DEVICE_TIME = Template(OK, 'Stamps are device time on ROS time')


class TimeTask:
    """
    Watches a clock. Only the thread that uses the clock may call update().

    stale returns whether no data arrives, and thus no stamps are made.
    """

    name = 'Time'
    messages = (EVENT, UNKNOWN_HELD, UNKNOWN, NO_PULSES, NO_DATA, ARRIVAL, REQUESTS_UNKNOWN,
                NO_ANSWER_YET, EXCHANGE, DEVICE_TIME)

    def __init__(self, clock: Clock, stale: Staleness) -> None:
        self._clock = clock
        self._stale = stale
        self._state = clock.state()
        self._updated_at = -UPDATE_PERIOD
        self._event, self._event_at = '', -NOTICE_LIFETIME

    def notice(self, event: str, now: float) -> None:
        """Show an event of the clocks for NOTICE_LIFETIME."""
        self._event, self._event_at = event, now

    def update(self, now: float) -> None:
        """Read the state of the clock, which is slow, once per UPDATE_PERIOD."""
        if now - self._updated_at >= UPDATE_PERIOD:
            self._state, self._updated_at = self._clock.state(), now

    def run(self, status: Status) -> Status:
        """Report how stamps are made at present."""
        status.values_from(self._values)
        if status.now - self._event_at < NOTICE_LIFETIME:
            return status.summary(EVENT, event=self._event)
        if self._stale(status.now):
            return status.summary(NO_DATA)
        return status.summary(_message(self._state), spread_ms=self._state.spread_us / 1000)

    def _values(self, _now: float) -> Mapping[str, str]:
        state = self._state
        return {
            'Source': state.source,
            'Source in use': state.in_use,
            **(_exchange_values(state) if state.source == 'exchange'
               else _device_values(state)),
            'Samples stamped with arrival': str(state.arrival_stamps),
            'Host clock set': f'{state.host_steps} times, last by {state.last_host_step_s:.6f} s'
            if state.host_steps else 'never',
            'Median chunk [bytes]': str(state.median_chunk),
            'Advice': _advice(state),
        }


def _message(state: TimeState) -> Template:
    if state.source == 'arrival':
        return ARRIVAL
    if state.source == 'exchange':
        if state.in_use == 'arrival':
            return REQUESTS_UNKNOWN
        return EXCHANGE if state.settled else NO_ANSWER_YET
    if not state.settled:
        return UNKNOWN_HELD if state.held else UNKNOWN
    return DEVICE_TIME if state.source == state.in_use else NO_PULSES


def _exchange_values(state: TimeState) -> Mapping[str, str]:
    return {'Half a request and its answer, median [us]':
            f'{state.spread_us:.1f}' if state.settled else 'unknown'}


def _device_values(state: TimeState) -> Mapping[str, str]:
    return {
        'Time messages name': _label(state),
        'ROS time less device time [s]': _format(state.offset_ns, 1e-9, '.6f'),
        'Skew [ppm]': f'{state.skew_ppm:.2f}',
        'Spread [us]': f'{state.spread_us:.1f}',
        'Period [us]': _format(state.period_us, 1.0, '.3f'),
        'Epochs': str(state.epochs),
        'Samples held': str(state.held),
        'Samples dropped': str(state.dropped),
        'Rejected measurements': str(state.rejected_samples),
        'Rejected time messages': str(state.rejected_time_messages),
        'Rejected counters': str(state.rejected_counters),
        'Sync pulses': f'{state.pulses}, spurious {state.pulses_spurious}, '
                       f'missing {state.pulses_missing}',
        'Least delay by pulses [us]': _format(state.pulse_delay_us, 1.0, '.1f'),
    }


def _label(state: TimeState) -> str:
    return {'next': 'the next sample', 'same': 'the sample just sent'}.get(
        state.label, state.label)


def _format(value: float | None, factor: float, precision: str) -> str:
    return 'unknown' if value is None else format(value * factor, precision)


def _advice(state: TimeState) -> str:
    if state.median_chunk <= LONG_CHUNK:
        return 'none'
    return ('the adapter holds bytes back: for lower latency set its timer to 1 ms, '
            'echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB*/latency_timer')
