# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of parsing numbers and names."""

from bahrs_driver.process.text_values import known, number, whole
import pytest


def test_valid_texts():
    """They become values."""
    assert number('-1.5', 'it', -2.0, 0.0) == -1.5
    assert whole('7', 'it', 0, 9) == 7
    assert known('a', 'letter', ('a', 'b')) == 'a'


@pytest.mark.parametrize(('call', 'says'), [
    (lambda: number('x', 'it'), "it is 'x': it must be a number of at least 0"),
    (lambda: number('3', 'it', 0, 2), "it is '3': it must be a number from 0 to 2"),
    (lambda: number('nan', 'it', float('-inf')), "it is 'nan': it must be a number$"),
    (lambda: number('inf', 'it'), "it is 'inf'"),
    (lambda: whole('1.5', 'it', 0, 9), "it is '1.5': it must be a whole number from 0 to 9"),
    (lambda: known('c', 'letter', ('a', 'b')), "there is no letter 'c', only a, b"),
])
def test_invalid_texts(call, says):
    """The error names what would be valid."""
    with pytest.raises(ValueError, match=says):
        call()
