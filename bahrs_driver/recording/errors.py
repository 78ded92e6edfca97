# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a capture."""

from collections.abc import Iterator
import contextlib

from bahrs_driver.files.guard import PathLike, sentence


class CaptureError(Exception):
    """One sentence for the user: what is wrong with a capture or a bag, and what to do."""


class DamageError(Exception):
    """Why a part of a bag cannot be used. The parts around it can."""


@contextlib.contextmanager
def guard_writing(target: PathLike, verb: str = 'write') -> Iterator[None]:
    """Convert every exception in the block, which writes a target, to a CaptureError."""
    try:
        yield
    except CaptureError:
        raise
    except Exception as error:
        raise CaptureError(sentence(error, target, verb)) from error
