# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure how fast the node ends after a signal at a random time; a third with the clock set back.

    PYTHONPATH=bench:test python bench/exits.py 300
"""

import argparse
import collections
from pathlib import Path
import tempfile

import numpy as np
from support.domain import use_own_domain
from support.random_starts import random_starts
from support.set_clock import SettableClock


def main() -> None:
    """Print exit statuses and the time from signal to end, in seconds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('count', type=int, nargs='?', default=300)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--from-birth', action='store_true',
                        help='also signal before the node has installed its handlers')
    options = parser.parse_args()
    use_own_domain()
    with tempfile.TemporaryDirectory() as folder:
        exits = list(random_starts(options.count, SettableClock(Path(folder)), options.seed,
                                   not options.from_birth))
    for each in exits:
        if each.status or each.duration > 1.0:
            print(each)
    durations = [each.duration for each in exits]
    print(f'{len(exits)} starts, {sum(each.clock_set_back for each in exits)} with the clock set '
          f'back; exit statuses {dict(collections.Counter(each.status for each in exits))}')
    print('seconds from signal to end: median {:.3f}, 99 % {:.3f}, largest {:.3f}'.format(
        *np.percentile(durations, (50, 99)), max(durations)))


if __name__ == '__main__':
    main()
