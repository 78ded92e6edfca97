# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find out which device a recording is from."""

from bahrs_driver.bag.capture import Capture
from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable


def sensor_of(capture: Capture | None, chosen: str | None) -> str:
    """Return the device that the user or the recording names; CommandError if unknown."""
    name = chosen or (capture and capture.sensor) or DEFAULT
    if capture and name not in DEVICES:
        raise CommandError(f"{printable(capture.path)} is of a sensor '{printable(name)}', which "
                           f'is not known here: choose one of {", ".join(DEVICES)} with --sensor')
    return name
