# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the picture of docs/clock.md: errors of stamps over time."""

from pathlib import Path

from clock_methods import Stamp, stamps_of_clock, stamps_of_others
from clock_simulation import Case
import matplotlib
matplotlib.use('Agg')
from matplotlib import pyplot    # noqa: E402, I100

STYLE = {'arrival': {'color': '#c0c0c0', 'marker': '.', 'linestyle': '', 'markersize': 1.5},
         'moving average': {'color': '#d97706', 'linewidth': 1.0},
         'this driver': {'color': '#1d4ed8', 'linewidth': 1.2}}


def draw(path: Path, case: Case, seed: int) -> None:
    """Draw the errors of a run into a file."""
    methods: dict[str, list[Stamp]] = {
        **stamps_of_others(case, seed), 'this driver': stamps_of_clock(case, seed)[0]}
    figure, (whole, near) = pyplot.subplots(2, 1, sharex=True, figsize=(9, 6))
    for method, style in STYLE.items():
        stamps = methods[method]
        whole.plot([stamp.time for stamp in stamps], [stamp.error_us / 1000 for stamp in stamps],
                   label=method, **style)
    near.plot([stamp.time for stamp in methods['this driver']],
              [stamp.error_us for stamp in methods['this driver']], **STYLE['this driver'])
    whole.set_ylim(-2, 40)
    near.set_ylim(0, 200)
    whole.set_ylabel('error / ms')
    near.set_ylabel('error of this driver / µs')
    near.set_xlabel('time since power-on / s')
    whole.legend(loc='upper right', markerscale=6)
    whole.set_title('Error of stamps: adapter with a latency timer of 16 ms')
    for axes in (whole, near):
        axes.grid(alpha=0.3)
    figure.tight_layout()
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
