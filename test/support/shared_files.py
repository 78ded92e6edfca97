# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Finds the files that lie beside the repository and not in it: recordings, vectors."""

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def shared_file(name: str) -> Path:
    """Return the path of a shared file, or skip the test that needs it."""
    folder = os.environ.get('BAHRS_SHARED')
    path = (Path(folder) if folder else REPOSITORY.parent / 'shared') / name
    if not path.is_file():
        pytest.skip(f'no file {name} in ../shared, nor in the folder that BAHRS_SHARED names')
    return path
