# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure the errors of stamps in all cases and by all methods, and the cost of a stamp.

Each run simulates ten minutes; no parameter was tuned with its seeds. With --node, also measure
in a subscriber, through a real pseudo-terminal, the driver and the middleware. Write
bench/clock.md and docs/clock.png.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
import sys
import time

from bahrs_driver.clock import ClockOptions, SampleClock, Stamped
from bahrs_driver.protocol.bahrs.roles import ROLES
from clock_converted import CONVERTED_HEADER, smoothed, through_the_node
from clock_methods import Stamp, stamps_of_clock, stamps_of_others
from clock_picture import draw
from clock_simulation import BYTE_TIME, Case, ORIGIN, plain_ros, Simulation
from clock_table import figures, HEADER, table

ROOT = Path(__file__).resolve().parents[1]
SEEDS = (101, 102, 103)
ADAPTERS = {'16 ms timer': 0.016, '62-byte packets': 'packets', '1 ms timer': 0.001,
            'plain': 'plain'}
SETTLED = 10.0          # s
STEP_US = 400_000       # less than the steps of the host's clock
PULSES = ClockOptions(source='sync_pulse')


def stepped(raw: int) -> int:
    """Return the ROS time of a host that is set at 200 s and at 400 s."""
    elapsed = raw - ORIGIN
    return plain_ros(raw) + 500_000_000 * (elapsed > 200e9) - 700_000_000 * (elapsed > 400e9)


def slewed(raw: int) -> int:
    """Return the ROS time of a host that is slewed by 500 ppm for 20 s."""
    return plain_ros(raw) + int(500e-6 * min(max(0, raw - ORIGIN - 200e9), 20e9))


CASES = {
    '1 % of frames lost': Case(loss=0.01),
    'device restarted twice': Case(restarts=(200.0, 400.0)),
    'host set by +0.5 s, -0.7 s': Case(ros=stepped),
    'host slewed by 500 ppm': Case(ros=slewed),
    'overload of 40 s': Case(overload=(200.0, 240.0)),
    'temperature, 10 ppm': Case(temperature_ppm=10.0),
    '1 % of counters damaged': Case(bad_counters=0.01),
    '5 % of time messages wrong': Case(bad_times=0.05),
    'first time message after 2.8 s': Case(first_time_message=2.8),
    'start as in the recording': Case(pause_before=16, pause=2.7),
    'time messages name the same sample': Case(label=0),
    'device clock off by 200 ppm': Case(drift_ppm=200.0),
}


def settled_errors(stamps: list[Stamp], case: Case, settled: float = SETTLED) -> list[float]:
    """
    Return the errors of a run, except while the clock settles after power-on.

    Samples measured before a step of the host's clock and read after it have the new time. Their
    errors are as large as the step, and are left out.
    """
    begins = (0.0, *case.restarts)
    return [stamp.error_us for stamp in stamps
            if stamp.time - max(begin for begin in begins if begin <= stamp.time) >= settled
            and abs(stamp.error_us) < STEP_US]


def adapters() -> Iterator[tuple[object, ...]]:
    """Yield a row per adapter and method."""
    for name, adapter in ADAPTERS.items():
        errors: dict[str, list[float]] = {}
        for seed in SEEDS:
            case = Case(adapter=adapter)
            for method, stamps in stamps_of_others(case, seed).items():
                errors.setdefault(method, []).extend(settled_errors(stamps, case))
            errors.setdefault('**this driver**', []).extend(
                settled_errors(stamps_of_clock(case, seed)[0], case))
            pulsed = replace(case, pulses=(1.0, case.seconds))
            errors.setdefault('**this driver, with pulses**', []).extend(
                settled_errors(stamps_of_clock(pulsed, seed, PULSES)[0], pulsed))
        for method, values in errors.items():
            yield name, method, *figures(values)


def cases() -> Iterator[tuple[object, ...]]:
    """Yield a row per case, adapter and clock source."""
    for name, case in CASES.items():
        for adapter in ('16 ms timer', '62-byte packets'):
            for method, options in (('passive', ClockOptions()), ('pulses', PULSES)):
                run = replace(case, adapter=ADAPTERS[adapter],
                              pulses=(1.0, case.seconds) if options is PULSES else (0.0, 0.0))
                stamps, clock = stamps_of_clock(run, SEEDS[0], options)
                state = clock.state()
                yield (f'{name}, {adapter}', method, *figures(settled_errors(stamps, run)),
                       sum(stamp.stamp > stamp.read for stamp in stamps),
                       sum(later.stamp <= earlier.stamp
                           for earlier, later in zip(stamps, stamps[1:])),
                       state.dropped)


def settling() -> Iterator[tuple[object, ...]]:
    """Yield a row per adapter: the largest errors after power-on and after a restart."""
    for name, adapter in ADAPTERS.items():
        worst = [0.0] * 4
        for seed in range(SEEDS[0], SEEDS[0] + 20):
            case = Case(40.0, adapter, restarts=(20.0,))
            stamps, _ = stamps_of_clock(case, seed)
            for index, (begin, end) in enumerate(((0, 2.6), (2.6, 20.3), (20.3, 21.9),
                                                  (21.9, 40))):
                worst[index] = max([worst[index]] + [
                    abs(stamp.error_us) for stamp in stamps if begin <= stamp.time < end])
        yield name, *worst


def converted() -> Iterator[tuple[object, ...]]:
    """Yield a row per case, live and converted, from the first stamp on."""
    runs = {name: Case(adapter=adapter) for name, adapter in ADAPTERS.items()}
    runs |= {f'{name}, 16 ms timer': CASES[name] for name in (
        '1 % of frames lost', 'device restarted twice', 'overload of 40 s',
        'temperature, 10 ppm', '5 % of time messages wrong', 'device clock off by 200 ppm')}
    for name, case in runs.items():
        for method, stamps in (('live', stamps_of_clock(case, SEEDS[0])[0]),
                               ('**converted**', smoothed(case, SEEDS[0]))):
            yield name, method, *figures(settled_errors(stamps, case, 0.0))


def cost() -> Iterator[tuple[object, ...]]:
    """Yield a row per adapter: microseconds per message; the floor only creates the tuples."""
    for name, adapter in ADAPTERS.items():
        reads = list(Simulation(Case(60.0, adapter), SEEDS[0]).reads())
        count = sum(len(messages) for _, _, messages in reads)

        def floor() -> None:
            for now, _, messages in reads:
                _ = [Stamped(message, frame, now.ros_ns) for message, frame in messages]

        def clock() -> None:
            made = SampleClock(ROLES)
            made.begin(BYTE_TIME)
            for now, received, messages in reads:
                made.observe_read(now, received)
                made.stamp(messages)

        floor_us, clock_us = best(floor) / count, best(clock) / count
        yield (name, f'{count / len(reads):.2f}', f'{floor_us:.2f}', f'{clock_us:.2f}',
               f'{clock_us / floor_us:.1f}')


def best(work: Callable[[], None], runs: int = 5) -> float:
    """Return the duration of the fastest of several runs, in microseconds."""
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times) * 1e6


def report(node: bool) -> Iterator[str]:
    """Yield the sections of the page."""
    yield ('# Errors of stamps\n\nWritten by `make bench-clock`. All figures are in microseconds: '
           'p50, p99 and maximum of the error, then of the error about its median ("wander"). A '
           'constant delay cannot be observed without pulses.')
    yield (f'## Adapters\n\nSimulated, {len(SEEDS)} runs of ten minutes, from {SETTLED:.0f} s on. '
           'The other methods use the true device time of every sample.')
    yield table(HEADER, adapters())
    yield '## Cases\n\nThis driver. The last three columns count stamps.'
    yield table((*HEADER, 'later than their read', 'not increasing', 'dropped'), cases())
    yield ('## Settling\n\nLargest error of 20 runs. The time of a held sample is that of the '
           'read that released it.')
    yield table(('adapter', 'first 2 s', 'until 20 s', 'first second after a restart',
                 'until 40 s'), settling())
    yield ('## Simulated recordings, live and converted\n\nThe same ten minutes live and by '
           '`bahrs convert`, from the first stamp on, with settling.')
    yield table(HEADER, converted())
    yield '## Cost\n\nMicroseconds per message, with the floor of the same run.'
    yield table(('adapter', 'messages per read', 'floor', 'clock', 'clock / floor'), cost())
    if node:
        from clock_node import measured, NODE_HEADER
        yield ('## In a subscriber\n\nAn emulated device on a real pseudo-terminal, the driver '
               'and the middleware, compared with the ground truth of the emulator. The floor is '
               'the minimum delay of each half second from a write into a pseudo-terminal to its '
               'reader, without a driver: no driver can be more stable than the host.')
        yield table(NODE_HEADER, measured())
        yield ('## A recorded flight, live and converted\n\nAn emulated device, the driver with '
               '`publish.raw`, `bahrs record` and `bahrs convert`; all stamps of both bags.')
        yield table(CONVERTED_HEADER, through_the_node())


def main() -> int:
    """Write the page and the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--node', action='store_true', help='also measure with the driver node')
    options = parser.parse_args()
    parts = []
    for part in report(options.node):
        print(part, end='\n\n', flush=True)
        parts.append(part)
    (ROOT / 'bench' / 'clock.md').write_text('\n\n'.join(parts) + '\n')
    draw(ROOT / 'docs' / 'clock.png', Case(60.0), SEEDS[0])
    return 0


if __name__ == '__main__':
    sys.exit(main())
