# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the spectral density of evenly spaced samples, and find the strongest line in it.

A line at half the sample rate is ambiguous: a vibration of any odd multiple of it looks like noise
that alternates from sample to sample. It is excluded from the search, with the frequencies over
which the window smears it, and reported separately. Every other line may be an alias.
"""

from typing import NamedTuple

from bahrs_driver.report.time_axis import Array
from matplotlib.mlab import psd
import numpy as np

WELCH = 4096                # samples of each piece of a spectrum
LINE = 3.0                  # times the median density, above which it is not noise
LOWEST_LINE = 1.0           # Hz
SMEAR = 3                   # frequencies on either side that a Hann window spreads a line over


class Lines(NamedTuple):
    """The lines of a spectrum."""

    strongest: float | None         # Hz, below half the sample rate; None without a line
    at_half_rate: bool


def density(values: Array, period: float) -> tuple[Array, Array]:
    """Return frequencies above 0 (Hz) and the square root of the power density at each."""
    size = min(WELCH, len(values) // 2 * 2)
    power, frequency = psd(values - values.mean(), NFFT=size, Fs=1 / period, noverlap=size // 2)
    return np.asarray(frequency)[1:-1], np.sqrt(power)[1:-1]     # both ends count half


def lines(values: Array, period: float) -> Lines:
    """Find the strongest line, and whether there is a line at half the sample rate."""
    frequency, found = density(values, period)
    inside = frequency > LOWEST_LINE
    limit = LINE * np.median(found[inside])
    at_half_rate = bool((found[-SMEAR:] > limit).any())
    inside[-SMEAR:] = False
    strongest = int(np.argmax(found[inside]))
    return Lines(float(frequency[inside][strongest]) if found[inside][strongest] > limit else None,
                 at_half_rate)
