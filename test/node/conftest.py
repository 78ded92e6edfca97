# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the tests of the node."""

from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest


@pytest.fixture
def cable():
    """Give a port made of a pseudo-terminal."""
    with PtyPort() as port:
        yield port
