# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of which signals end a verb."""

import signal

from bahrs_driver.cli.signals import ENDING, heeded
import pytest


@pytest.mark.parametrize(('before', 'kinds'), [
    (signal.SIG_DFL, [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]),
    (signal.SIG_IGN, [signal.SIGINT, signal.SIGTERM]),
])
def test_a_hang_up_is_left_ignored(before, kinds):
    """As nohup has it."""
    own = signal.signal(signal.SIGHUP, before)
    try:
        assert heeded(ENDING) == kinds
    finally:
        signal.signal(signal.SIGHUP, own)
