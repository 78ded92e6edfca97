# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Statistics of the errors of stamps, as a table in Markdown."""

from collections.abc import Iterable, Sequence
from statistics import median

HEADER = ('case', 'method', 'p50', 'p99', 'max', 'wander p99', 'wander max')


def quantile(values: Sequence[float], share: float) -> float:
    """Return a quantile of ascending values."""
    return values[min(len(values) - 1, int(share * len(values)))]


def figures(errors: Iterable[float]) -> tuple[float, float, float, float, float]:
    """Return p50, p99 and maximum of the errors, then p99 and maximum about their median."""
    errors = list(errors)
    middle = median(errors)
    plain = sorted(map(abs, errors))
    about = sorted(abs(error - middle) for error in errors)
    return (quantile(plain, 0.5), quantile(plain, 0.99), plain[-1], quantile(about, 0.99),
            about[-1])


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in Markdown, with numbers rounded to integers."""
    lines = ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)]
    lines += ['| ' + ' | '.join(_cell(value) for value in row) + ' |' for row in rows]
    return '\n'.join(lines)


def _cell(value: object) -> str:
    return f'{value:,.0f}' if isinstance(value, float) else str(value)
