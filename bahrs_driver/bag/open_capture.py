# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Open a recording of raw bytes in any format."""

from pathlib import Path

from bahrs_driver.bag.bag_kind import is_bag
from bahrs_driver.bag.capture import ByteFile, Capture
from bahrs_driver.errors import CaptureError
from bahrs_driver.process.printable import printable


def open_capture(path: str | Path, topic: str | None = None) -> Capture:
    """
    Open a file of bytes or a bag; CaptureError if it cannot be read.

    topic names the bag's topic of raw bytes, if there are several. Damaged parts are left out,
    with a note.
    """
    path, shown = Path(path), printable(path)
    try:
        if not is_bag(path):
            with path.open('rb'):
                return ByteFile(path, path.stat().st_size)
        from bahrs_driver.bag.bag_capture import BagCapture
        return BagCapture(path, topic)
    except OSError as error:
        raise CaptureError(f'cannot read {shown}: {error.strerror}') from error
    except ModuleNotFoundError as error:
        raise CaptureError(f'{shown} is a bag, and the Python module {error.name} is missing: '
                           'install mcap') from error
