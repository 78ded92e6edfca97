# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The rate at which a library parses a stream, for each library in an environment of its own.

This module imports only the standard library, because it runs beside each peer.
"""

from collections.abc import Callable
import time

CHUNK = 4096            # bytes
RUNS = 3
SECONDS = 200           # of a stream
MESSAGES = 310 * SECONDS

Encode = Callable[[int], bytes]


def mix(inertial: Encode, attitude: Encode, clock: Encode) -> bytes:
    """
    Return a stream with three kinds of messages at the rates of a BAHRS.

    Each encodes the message of a sample, whose number, 0 to 199, makes its values.
    """
    second = b''.join(inertial(index) + (attitude(index) if index % 2 == 0 else b'')
                      + (clock(index) if index % 20 == 0 else b'') for index in range(200))
    return second * SECONDS


def print_rate(count: Callable[[bytes], int], data: bytes) -> None:
    """
    Print the messages per second of processor time, of the fastest of several runs.

    count parses a stream in chunks of 4 KiB into typed messages and returns how many there are.
    Assert that it finds all of them, and that it checks checksums: one less in a damaged stream.
    """
    assert count(data) == MESSAGES
    damaged = bytearray(data)
    damaged[12] ^= 0x10         # in the payload of the first message
    assert count(bytes(damaged)) == MESSAGES - 1
    print(MESSAGES / best_cpu_time(lambda: count(data)))


def chunks(data: bytes) -> list[bytes]:
    """Return a stream in chunks."""
    return [data[start:start + CHUNK] for start in range(0, len(data), CHUNK)]


def best_cpu_time(work: Callable[[], object]) -> float:
    """Return the processor time of the fastest of several runs, in s."""
    times = []
    for _ in range(RUNS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)
