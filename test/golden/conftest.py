# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The option that writes the golden files."""


def pytest_addoption(parser):
    """Add --write-golden; it exists only if the tests of this directory are named."""
    parser.addoption('--write-golden', action='store_true',
                     help='store the hashes of the current output; print and fail what changed')
