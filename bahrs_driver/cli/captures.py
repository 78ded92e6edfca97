# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Opening what a device sent, with a plain sentence where it cannot be used."""

from collections.abc import Collection

from bahrs_driver.cli.errors import CommandError
from bahrs_driver.printable import printable
from bahrs_driver.recording.capture import Capture, read_capture
from bahrs_driver.recording.errors import CaptureError

DEFAULT_SENSOR = 'bahrs'


def open_capture(path: str, topic: str | None) -> Capture:
    """Open a bag or a file of bytes; CommandError if it cannot be read."""
    try:
        return read_capture(path, topic)
    except CaptureError as error:
        raise CommandError(str(error)) from error


def sensor_of(capture: Capture | None, chosen: str | None, known: Collection[str]) -> str:
    """Return the sensor that was chosen, or that of the recording; CommandError if unknown."""
    name = chosen or (capture and capture.sensor) or DEFAULT_SENSOR
    if capture and name not in known:
        raise CommandError(f"{printable(capture.path)} is of a sensor '{printable(name)}', which "
                           f'is not known here: choose one of {", ".join(known)} with --sensor')
    return name
