# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure every row of the table in docs/performance.md; fail if one is beyond its limit.

Without --rows, all rows are measured, and the table is written to bench/RESULTS.md and to
docs/performance.md.
"""

import argparse
from collections.abc import Callable, Iterator
import subprocess
import sys

from harness.machine import conditions
from harness.recording import ROOT
from harness.results import line, page, table, with_table
from harness.row import failures, Fault, Row
from rows import arrays, cpu, delay, saturated_line, start, stream, verbs
from support.domain import use_own_domain

GROUPS: dict[str, Callable[[], Iterator[Row]]] = {
    'cpu': cpu.measure, 'latency': delay.measure, 'saturation': saturated_line.measure,
    'start': start.measure, 'stream': stream.measure, 'arrays': arrays.measure,
    'decode': verbs.decode, 'report': verbs.report, 'convert': verbs.convert,
    'emulate': verbs.emulate}
RESULTS = ROOT / 'bench' / 'RESULTS.md'
DOCUMENTATION = ROOT / 'docs' / 'performance.md'


def main() -> int:
    """Return 1 if a row is beyond its limit or a group cannot be measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rows', help=f"groups, with commas: {', '.join(GROUPS)}")
    chosen = parser.parse_args().rows
    groups = chosen.split(',') if chosen else list(GROUPS)
    if unknown := set(groups) - GROUPS.keys():
        parser.error(f"no rows {', '.join(unknown)}; there are {', '.join(GROUPS)}")
    use_own_domain()
    facts = conditions(stream.PEERS)
    for name, value in facts.items():
        print(f'{name}: {value}')
    rows, faults = measure(groups)
    if not chosen:
        RESULTS.write_text(page(rows, faults, facts))
        DOCUMENTATION.write_text(with_table(DOCUMENTATION.read_text(), table(rows, faults)))
    found = failures(rows, faults)
    print('\n'.join(found) or f'all {len(rows)} rows are within their limits')
    return 1 if found else 0


def measure(groups: list[str]) -> tuple[list[Row], list[Fault]]:
    """Measure groups of rows, and print each row."""
    rows: list[Row] = []
    faults: list[Fault] = []
    for name in groups:
        try:
            for row in GROUPS[name]():
                rows.append(row)
                print(line(row), flush=True)
        except (AssertionError, OSError, ValueError, subprocess.CalledProcessError) as error:
            faults.append(Fault(name, f'{type(error).__name__}: {error}'))
            print(f'FAIL {name}: {error}', flush=True)
    return rows, faults


if __name__ == '__main__':
    sys.exit(main())
