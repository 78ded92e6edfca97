# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Foreign text is shown, never obeyed."""

from bahrs_driver.process.printable import LONGEST_TEXT, printable
from hypothesis import given, strategies as st
import pytest


@pytest.mark.parametrize('text, shown', [
    ('BAHRS 3.1', 'BAHRS 3.1'),
    ('Größe 25 °C', 'Größe 25 °C'),
    ('\x1bc', '\\x1bc'),
    ('a\nb\r\tc', 'a\\x0ab\\x0d\\x09c'),
    ('\x9b31m', '\\x9b31m'),                    # CSI in one character
    ('\u202egnp.exe', '\\u202egnp.exe'),        # right-to-left override
    ('\u2028', '\\u2028'),
    ('\U000e0001', '\\U000e0001'),
    (b'caf\xe9'.decode(errors='surrogateescape'), 'caf\\xe9'),
    (17, '17'),
])
def test_each_kind_of_character(text, shown):
    """Control characters become escapes; letters stay."""
    assert printable(text) == shown


@given(st.text(st.characters(), max_size=2 * LONGEST_TEXT), st.integers(1, LONGEST_TEXT))
def test_any_text_is_one_line_that_can_be_encoded(text, limit):
    """Any text becomes printable and valid UTF-8."""
    shown = printable(text, limit)
    assert shown.isprintable() or not shown
    assert len(shown) <= limit
    shown.encode()
    assert printable(shown, limit) == shown
