# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the protocol tests: the shared vectors and the real recording."""

import json
from typing import Any

import pytest
from support.shared_files import shared_file


@pytest.fixture(scope='session')
def vectors() -> list[dict[str, Any]]:
    """Return the BAHRS frames generated independently of this project."""
    content = json.loads(shared_file('vectors/frames.json').read_text())
    return [vector for vector in content if vector['device'] == 'bahrs']


@pytest.fixture(scope='session')
def recording() -> bytes:
    """Return 240 s of a real device of protocol version 2 at rest."""
    return shared_file('data/bahrs_recording_v2.bin').read_bytes()
