# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What `bahrs report` makes of a recording.

`gather` reads it into arrays, `timeline` puts the samples on one axis of time, `clock` compares
the device's clock with the host's, `rest` finds where the device stood still, `allan` tells noise
from drift, `findings` says in words what is to be known, `decimate` and `plots` draw, and `page`
puts it all on one page. Vectors and attitude are those of the device: forward, right, down.
"""

import logging

# Which says at its first use that it is building a cache, if that takes long.
logging.getLogger('matplotlib').setLevel(logging.ERROR)
