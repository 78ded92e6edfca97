# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Analyze a recording, and write the page of `bahrs report`.

`gather` reads it into arrays, `time_axis` computes the times of samples, `clock` compares the
clocks of device and host, `rest` finds when the device was at rest, `noise` analyzes the noise
then (with `spectrum` and `allan`), `findings` describes the results in sentences, `plots` and
`noise_plots` draw, and `page` writes the page. Vectors and attitude are in the axes of the device:
forward, right, down.
"""

import logging

# At its first use matplotlib logs that it builds a font cache.
logging.getLogger('matplotlib').setLevel(logging.ERROR)
