# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The table of all rows as Markdown, and its place in a page."""

from collections.abc import Mapping, Sequence

from harness.row import Bound, Fault, Row

HEAD = ('what', 'floor or peer', 'driver', 'ratio', 'target', 'met', 'limit', 'held')
BEGIN, END = '<!-- make bench -->', '<!-- end of make bench -->'
_VERDICT = {True: 'yes', False: 'no', None: '-'}


def number(value: float) -> str:
    """Return a number with about three digits, two if it is small."""
    if abs(value) < 0.1:
        return f'{value:.2g}'
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2
    return f'{value:,.{digits}f}'


def bound_text(bound: Bound | None, unit: str) -> str:
    """Return a bound in words."""
    if bound is None:
        return '-'
    sign = '>=' if bound.smallest else '<='
    return {'ours': f'{sign} {number(bound.value)} {unit}',
            'ratio': f'{sign} {number(bound.value)} x',
            'difference': f'{sign} floor + {number(bound.value)} {unit}'}[bound.quantity]


def cells(row: Row) -> tuple[str, ...]:
    """Return the cells of a row, in the order of HEAD."""
    ratio = row.quantity('ratio')
    floor = row.floor_name or '-' if row.floor is None \
        else f'{row.floor_name}: {number(row.floor)} {row.unit}'
    note = f' ({row.note})' if row.note else ''
    return (row.what + note, floor, f'{number(row.ours)} {row.unit}',
            '-' if ratio is None else f'{number(ratio)} x',
            bound_text(row.target, row.unit), _VERDICT[row.holds(row.target)],
            bound_text(row.limit, row.unit), '**no**' if row.failed
            else _VERDICT[row.holds(row.limit)])


def line(row: Row) -> str:
    """Return a row for a terminal."""
    what, floor, ours, ratio, target, met, limit, _ = cells(row)
    verdict = 'FAIL' if row.failed else 'ok  '
    return (f'{verdict} {what}: {ours}, {floor}, ratio {ratio}, '
            f'target {target}, met: {met}, limit {limit}')


def table(rows: Sequence[Row], faults: Sequence[Fault]) -> str:
    """Return the table; a group without a result has a row that says why."""
    found = [HEAD, ('---',) * len(HEAD), *map(cells, rows)]
    found += [(fault.group, '-', fault.reason, '-', '-', '-', '-', '**no**') for fault in faults]
    return '\n'.join(f"| {' | '.join(texts)} |" for texts in found) + '\n'


def page(rows: Sequence[Row], faults: Sequence[Fault], conditions: Mapping[str, str]) -> str:
    """Return the whole page of results."""
    facts = '\n'.join(f'- {name}: {value}' for name, value in conditions.items())
    return ('# Results of `make bench`\n\nWritten by `make bench`; '
            '[docs/performance.md](../docs/performance.md) explains the rows.\n\n'
            f'{facts}\n\n{table(rows, faults)}')


def with_table(text: str, new: str) -> str:
    """Return a page with another table between its two markers."""
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    return f'{before}{BEGIN}\n\n{new}\n{END}{after}'
