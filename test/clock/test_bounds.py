# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the bounds of frames, with literal numbers: a byte takes 100 ns."""

from bahrs_driver.clock.bounds import ByteBounds, MAX_READS


def bounds(*reads):
    """Return the bounds by reads, each with its time and the bytes received by then."""
    made = ByteBounds(100)
    for read in reads:
        made.observe_read(*read)
    return made


def test_bound_of_a_frame_at_the_end_of_its_chunk():
    """The bytes of the frame were transmitted after its beginning."""
    assert bounds((10_000, 28)).bound(0) == 10_000 - 2800


def test_bound_of_a_frame_with_bytes_after_it():
    """The later bytes were transmitted after its beginning as well."""
    both = bounds((10_000, 56))
    assert [both.bound(0), both.bound(28)] == [10_000 - 5600, 10_000 - 2800]


def test_a_frame_cut_by_a_read_has_a_tighter_bound():
    """The read of its first five bytes was in time; the read of its end was late."""
    assert bounds((10_000, 5), (90_000, 28)).bound(0) == 10_000 - 500


def test_an_early_read_after_a_late_one_gives_the_bound():
    """The bound is the smallest of all reads."""
    assert bounds((10_000, 5), (10_050, 28)).bound(0) == 10_050 - 2800


def test_a_read_before_the_frame_gives_no_bound():
    """The read was early."""
    assert bounds((1_000, 28), (50_000, 56)).bound(28) == 50_000 - 2800


def test_memory_is_bounded_and_bounds_stay_valid():
    """Many reads bring no frame."""
    made = bounds(*((1000 * index, index) for index in range(1, 10 * MAX_READS)))
    assert made.bound(0) >= 1000 - 100
    assert made.bound(10 * MAX_READS - 2) == 1000 * (10 * MAX_READS - 1) - 100


def test_without_a_line_rate_the_bound_is_the_first_read():
    """Native USB and networks have no line rate."""
    made = ByteBounds(0)
    made.observe_read(500, 10)
    made.observe_read(900, 28)
    assert made.bound(3) == 500
