# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a recording."""


class CaptureError(Exception):
    """A recording cannot be read or written. The text is one sentence that says which and why."""
