# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a capture."""


class CaptureError(Exception):
    """One sentence for the user: what is wrong with a capture or a bag, and what to do."""


class DamageError(Exception):
    """Why a part of a bag cannot be used. The parts around it can."""
