# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Which sensor a recording is of."""

from collections.abc import Collection

from bahrs_driver.bag.capture import Capture
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable

DEFAULT_SENSOR = 'bahrs'


def sensor_of(capture: Capture | None, chosen: str | None, known: Collection[str]) -> str:
    """Return the sensor that was chosen, or that of the recording; CommandError if unknown."""
    name = chosen or (capture and capture.sensor) or DEFAULT_SENSOR
    if capture and name not in known:
        raise CommandError(f"{printable(capture.path)} is of a sensor '{printable(name)}', which "
                           f'is not known here: choose one of {", ".join(known)} with --sensor')
    return name
