# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure what is lost from a saturated line, alone and beside two processes that are always busy.

A process writes inertial frames at the full rate of the line: 3,291 a second at 921,600 baud. The
node publishes them, and a reliable subscriber in a third process counts them by their numbers.
"""

import argparse
from collections.abc import Iterator
import contextlib
import json
import subprocess
import sys
from typing import Any

from node_cpu import cpu_seconds, script
from support.domain import use_own_domain
from support.processes import driver, Process
from support.waiting import wait_for

BUSY = 2                    # processes
TOPIC = 'imu/data_raw'
Counts = dict[str, Any]


@contextlib.contextmanager
def busy_processes(count: int) -> Iterator[None]:
    """Run processes that compute all the time."""
    processes = [subprocess.Popen([sys.executable, '-c', 'while True: pass'])
                 for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def latest(process: Process) -> Counts:
    """Return the latest counts that a process has printed."""
    lines = [line for line in list(process.lines) if line.startswith('{') and line[-1] == '\n']
    return json.loads(lines[-1]) if lines else {}


def in_use(subscriber: Process) -> bool:
    """Return whether the node has found the subscriber."""
    unused = latest(subscriber).get('diagnostics', {}).get('Publishing Without subscriber', TOPIC)
    return TOPIC not in unused.split(', ')


def complete(subscriber: Process) -> bool:
    """Return whether the node is silent, and the subscriber has received nothing more."""
    before, last = (json.loads(line) for line in subscriber.lines[-2:])
    return bool(last['messages']['Rates'].startswith('No data')
                and last['received'] == before['received'])


def measure(baud_rate: int, duration: float, busy: int) -> tuple[Counts, Counts, float]:
    """Return what writer and subscriber counted, and the share of the node in percent."""
    with contextlib.ExitStack() as stack:
        writer = stack.enter_context(script('line_writer', '--baud-rate', str(baud_rate),
                                            '--duration', str(duration)))
        assert wait_for(lambda: writer.lines), writer.text
        subscriber = stack.enter_context(script('numbered_subscriber'))
        assert wait_for(lambda: subscriber.lines), subscriber.text
        node = stack.enter_context(driver(writer.lines[0].strip(), baud_rate=baud_rate))
        assert wait_for(lambda: in_use(subscriber)), node.text
        stack.enter_context(busy_processes(busy))
        before = cpu_seconds(node.pid)
        writer.send_line('write')
        assert wait_for(lambda: latest(writer), 2 * duration + 60), writer.text
        used = cpu_seconds(node.pid) - before
        assert wait_for(lambda: complete(subscriber)), subscriber.text
        return latest(writer), latest(subscriber), 100 * used / duration


def show(line: Counts, counts: Counts, cpu: float) -> None:
    """Print what was lost where."""
    diagnostics = counts['diagnostics']
    frames, published = (int(diagnostics[name]) for name in (
        'Framing Frames', f'Publishing {TOPIC}'))
    print(f'  sent {line["sent"]:,}; lost before the driver {line["dropped"]}, '
          f'in the driver {line["sent"] - published}, '
          f'to the subscriber {published - counts["received"]}')
    print(f'  shown: framing {frames:,} frames, CRC failures '
          f'{diagnostics["Framing CRC failures"]}, lost {diagnostics["Rates inertial lost"]}; '
          f'subscriber: gaps {counts["lost"]}')
    print(f'  most bytes not accepted at once {line["most_waiting"]:,}; longest pause of the '
          f'writer {line["longest_pause_ms"]} ms, of the subscriber {counts["longest_ms"]} ms; '
          f'node {cpu:.0f} % of a core', flush=True)


def main() -> None:
    """Measure and print all rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--baud-rate', type=int, default=921_600)
    parser.add_argument('--duration', type=float, default=60.0, help='seconds for each row')
    parser.add_argument('--busy', type=int, nargs='*', default=[0, BUSY],
                        help='busy processes in each row')
    options = parser.parse_args()
    use_own_domain()
    for busy in options.busy:
        print(f'{options.baud_rate:,} baud for {options.duration:g} s, {busy} busy processes:')
        show(*measure(options.baud_rate, options.duration, busy))


if __name__ == '__main__':
    main()
