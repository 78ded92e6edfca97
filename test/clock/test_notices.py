# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the queue of notices."""

from bahrs_driver.clock.notices import KEPT, Notices


def test_each_notice_is_taken_once():
    """Notices keep their order."""
    notices = Notices()
    notices.add('one')
    notices.add('two')
    assert notices.take() == ['one', 'two'] and notices.take() == []


def test_only_the_latest_notices_are_kept():
    """The first pass over a recording takes none."""
    notices = Notices()
    for number in range(1000):
        notices.add(str(number))
    assert notices.take() == [str(number) for number in range(1000 - KEPT, 1000)]
