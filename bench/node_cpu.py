# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure the processor time of the node, and of a bare publisher as its floor, in one run.

The emulated device writes 200 inertial, 100 navigation and 10 time messages a second to a
pseudo-terminal. With subscribers, one process subscribes to every topic. The bare publisher sends
ready-made messages at the same rates. Times are user and system time of all threads.
"""

import argparse
from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import sys
import tempfile
import time

from support.domain import use_own_domain
from support.processes import driver, Process, running
from support.waiting import wait_for

HERE = Path(__file__).parent
SETTLING = 8.0          # s before the measurement


def cpu_seconds(pid: int) -> float:
    """Return the processor time of all threads of a process, in s; ticks are too coarse."""
    return sum(int(file.read_text().split()[0])
               for file in Path(f'/proc/{pid}/task').glob('*/schedstat')) / 1e9


def share(process: Process, duration: float) -> float:
    """Return the share of a core that a process uses, in percent, once settled."""
    time.sleep(SETTLING)
    before, begin = cpu_seconds(process.pid), time.monotonic()
    time.sleep(duration)
    used, elapsed = cpu_seconds(process.pid) - before, time.monotonic() - begin
    assert process.alive, process.text
    return 100 * used / elapsed


@contextlib.contextmanager
def script(name: str, *words: str) -> Iterator[Process]:
    """Run a module of this directory in a process."""
    process = Process([sys.executable, str(HERE / f'{name}.py'), *words])
    try:
        yield process
    finally:
        process.end()


def measure_bare(duration: float) -> float:
    """Return the share of the bare publisher, in percent."""
    with script('bare_publisher') as process:
        assert wait_for(lambda: 'ready' in process.text)
        return share(process, duration)


def measure_node(duration: float, latency_timer: str) -> float:
    """Return the share of the node beside an emulated device, in percent."""
    with tempfile.TemporaryDirectory() as folder:
        port = f'{folder}/port'
        with running('bahrs', 'emulate', '--link', port, '--wait', '--seed', '1',
                     '--latency-timer', latency_timer) as device:
            assert wait_for(lambda: device.lines), device.text
            with driver(port) as process:
                assert wait_for(lambda: 'is open' in process.text), process.text
                return share(process, duration)


def measure_idle(duration: float) -> tuple[float, float]:
    """Return the shares of a node with a silent port and with a missing one, in percent."""
    controller, device = os.openpty()
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, controller)
        stack.callback(os.close, device)
        with driver(os.ttyname(device)) as process:
            assert wait_for(lambda: 'is open' in process.text), process.text
            silent = share(process, duration)
    with driver('/dev/no-such-port') as process:
        assert wait_for(lambda: process.lines), process.text
        return silent, share(process, duration)


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--duration', type=float, default=20.0, help='seconds for each row')
    parser.add_argument('--latency-timer', default='1', help='of the adapter, in ms, or none')
    options = parser.parse_args()
    duration, timer = options.duration, options.latency_timer
    use_own_domain()
    alone, bare_alone = measure_node(duration, timer), measure_bare(duration)
    with script('counting_subscriber') as subscriber:
        assert wait_for(lambda: subscriber.lines), subscriber.text
        bare, node = measure_bare(duration), measure_node(duration, timer)
        print(subscriber.lines[-1])
    silent, missing = measure_idle(duration)
    print(f'subscribed    bare {bare:5.2f} %  node {node:5.2f} %  {node / bare:.2f} x')
    print(f'no subscriber bare {bare_alone:5.2f} %  node {alone:5.2f} %  '
          f'{alone / node:.2f} x the subscribed node')
    print(f'port silent {silent:.2f} %, missing {missing:.2f} %')


if __name__ == '__main__':
    main()
