# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the spectral density of evenly spaced samples, and find the strongest line in it.

A line at the Nyquist frequency, half the sample rate, is ambiguous: a vibration of any odd
multiple of it looks like noise that alternates from sample to sample. It is excluded from the
search, with the frequencies over which the window spreads it, and reported separately. Every other
line may be an alias.
"""

from typing import NamedTuple

from bahrs_driver.protocol.batch import Array
from matplotlib.mlab import psd
import numpy as np

SEGMENT = 4096              # samples of each segment of Welch's method
LINE_THRESHOLD = 3.0        # times the median density, above which it is not noise
LOWEST_LINE = 1.0           # Hz
LEAKAGE = 3                 # frequencies on either side that a Hann window spreads a line over


class SpectralLines(NamedTuple):
    """The lines of a spectrum."""

    strongest: float | None         # Hz, below the Nyquist frequency; None without a line
    at_nyquist: bool


def amplitude_density(values: Array, period: float) -> tuple[Array, Array]:
    """Return frequencies above 0 (Hz) and the square root of the power density at each."""
    size = min(SEGMENT, len(values) // 2 * 2)
    power, frequency = psd(values - values.mean(), NFFT=size, Fs=1 / period, noverlap=size // 2)
    return np.asarray(frequency)[1:-1], np.sqrt(power)[1:-1]     # both ends count half


def find_lines(values: Array, period: float) -> SpectralLines:
    """Find the strongest line, and whether there is a line at the Nyquist frequency."""
    frequency, density = amplitude_density(values, period)
    searched = frequency > LOWEST_LINE
    threshold = LINE_THRESHOLD * np.median(density[searched])
    at_nyquist = bool((density[-LEAKAGE:] > threshold).any())
    searched[-LEAKAGE:] = False
    frequency, density = frequency[searched], density[searched]
    strongest = int(np.argmax(density))
    return SpectralLines(
        float(frequency[strongest]) if density[strongest] > threshold else None, at_nyquist)
