# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Open a recording for a conversion."""

from pathlib import Path

from bahrs_driver.bag.capture import Capture
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.errors import CaptureError
from bahrs_driver.process.printable import printable


def open_recording(path: str | Path, topic: str | None = None,
                   sensor: str | None = None) -> tuple[Capture, str]:
    """
    Return a recording and the name of its device; CaptureError if it cannot be converted.

    topic and sensor are None for those that the recording names.
    """
    _refuse_pipe(Path(path))
    capture = open_capture(path, topic)
    name = sensor_of(capture, sensor)
    spec = DEVICES[name]
    if not capture.timed and not spec.recording_format(spec.settings()):
        raise CaptureError(f'{printable(path)} cannot be converted: answers of a {name} have no '
                           'times; record the topic raw, or show them with bahrs decode')
    return capture, name


def sensor_of(capture: Capture | None, chosen: str | None) -> str:
    """Return the device that the user or the recording names; CaptureError if unknown."""
    name = chosen or (capture and capture.sensor) or DEFAULT
    if capture and name not in DEVICES:
        raise CaptureError(f"{printable(capture.path)} is of a sensor '{printable(name)}', which "
                           f'is not known here: choose one of {", ".join(DEVICES)} as its sensor')
    return name


def no_frames(path: str | Path, sensor: str) -> CaptureError:
    """Return the error for a recording without any frame of its device."""
    return CaptureError(f'no frame of a {sensor} in {printable(path)}')


def _refuse_pipe(source: Path) -> None:
    """Raise CaptureError for an input that cannot be read twice, such as a pipe."""
    if source.exists() and not (source.is_file() or source.is_dir()):
        raise CaptureError(f'{printable(source)} is not a regular file, and a conversion reads '
                           'its input twice: write the bytes into a file first')
