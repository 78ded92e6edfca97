# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The table that the benchmark writes."""

from harness.results import BEGIN, END, line, number, page, table, with_table
from harness.row import at_least, at_most, Fault, Row
import pytest

SLOW = Row('slow', 8.0, 's', at_most('ratio', 3), at_most('ours', 2), 2.0, 'floor', '1 MB')
FAST = Row('stream', 5000.0, 'k/s', at_least('ratio', 2), at_least('ratio', 9), 1000.0, 'peer')
ALONE = Row('memory', 0.456, 'MB', at_most('difference', 1))


@pytest.mark.parametrize('value, text', [
    (0.0, '0'), (0.0456, '0.046'),
    (1.234, '1.23'), (12.34, '12.3'), (123.4, '123'), (12345.6, '12,346')])
def test_numbers_have_about_three_digits(value, text):
    """No exponent."""
    assert number(value) == text


def test_a_row_has_floor_ratio_target_and_limit():
    """A limit that does not hold stands out."""
    assert table([SLOW, FAST, ALONE], []).splitlines()[2:] == [
        '| slow (1 MB) | floor: 2.00 s | 8.00 s | 4.00 x | <= 2.00 s | no | <= 3.00 x | **no** |',
        '| stream | peer: 1,000 k/s | 5,000 k/s | 5.00 x | >= 9.00 x | no | >= 2.00 x | yes |',
        '| memory | - | 0.46 MB | - | - | - | <= floor + 1.00 MB | - |']


def test_a_group_without_result_says_why():
    """In a row of its own."""
    assert table([], [Fault('arrays', 'no file')]).splitlines()[-1] \
        == '| arrays | - | no file | - | - | - | - | **no** |'


def test_a_line_begins_with_the_verdict():
    """For a terminal."""
    assert line(SLOW).startswith('FAIL slow') and line(FAST).startswith('ok   stream')


def test_the_page_names_machine_and_versions():
    """Above the table."""
    assert '- machine: a box\n\n| what |' in page([SLOW], [], {'machine': 'a box'})


def test_the_table_is_replaced_between_its_markers():
    """Again and again."""
    text = f'before\n{BEGIN}\nold\n{END}\nafter\n'
    once = with_table(text, 'new\n')
    assert once == f'before\n{BEGIN}\n\nnew\n\n{END}\nafter\n'
    assert with_table(once, 'new\n') == once
