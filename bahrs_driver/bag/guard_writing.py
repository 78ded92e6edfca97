# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Convert every failure to write a bag to one exception."""

from collections.abc import Iterator
import contextlib

from bahrs_driver.errors import CaptureError
from bahrs_driver.files.guard import PathLike, sentence


@contextlib.contextmanager
def guard_writing(target: PathLike, verb: str = 'write') -> Iterator[None]:
    """Convert every exception in the block, which writes a target, to a CaptureError."""
    try:
        yield
    except CaptureError:
        raise
    except Exception as error:
        raise CaptureError(sentence(error, target, verb)) from error
