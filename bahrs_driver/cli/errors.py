# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How a verb says that it cannot do what was asked."""


class CommandError(Exception):
    """One sentence that says what is wrong and what would be right."""
