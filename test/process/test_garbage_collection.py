# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of collecting garbage rarely."""

import gc

from bahrs_driver.process.garbage_collection import rare_collections, THRESHOLDS
import pytest


def test_thresholds_are_restored():
    """They hold for the block only, even if it fails."""
    before = gc.get_threshold()
    with pytest.raises(ValueError, match='reason'), rare_collections():
        assert gc.get_threshold() == THRESHOLDS
        raise ValueError('reason')
    assert gc.get_threshold() == before and gc.isenabled()
