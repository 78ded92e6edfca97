# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of bias and noise."""

import random
import statistics

from bahrs_driver.emulator.measurement_errors import MeasurementErrors, parse_bias, parse_deviation
import pytest


def test_without_parameters_the_truth_is_measured():
    """The measured values equal the true values."""
    errors = MeasurementErrors(1)
    assert errors.add_vector('specific_force', (0.1, -0.2, -9.8)) == (0.1, -0.2, -9.8)
    assert errors.add('pressure_height', 100.0) == 100.0


def test_deviation_and_bias_are_as_requested():
    """Ten thousand samples agree within their statistics."""
    noise = MeasurementErrors(3, {'pressure_height': 0.5}, {'pressure_height': (2.0,)})
    errors = [noise.add('pressure_height', 100.0) - 100.0 for _ in range(10_000)]
    assert statistics.mean(errors) == pytest.approx(2.0, abs=0.02)
    assert statistics.pstdev(errors) == pytest.approx(0.5, rel=0.03)


def test_the_seed_decides():
    """The same seed gives the same noise, another seed other noise."""
    draws = [MeasurementErrors(seed, {'angular_rate': 1.0}).add_vector('angular_rate', (0.0,) * 3)
             for seed in (1, 1, 2)]
    assert draws[0] == draws[1] != draws[2]


def test_texts_become_parameters():
    """A bias has a value for each component."""
    assert parse_deviation('angular_rate=0.001') == ('angular_rate', 0.001)
    assert parse_bias('specific_force=0.1,0,-0.2') == ('specific_force', (0.1, 0.0, -0.2))
    assert parse_bias('pressure_height=-3') == ('pressure_height', (-3.0,))


def test_the_noise_is_that_of_random_gauss():
    """Whose numbers a test or a user may know."""
    noise = MeasurementErrors(7, {'angular_rate': 0.5, 'velocity_down': 2.0})
    drawn = [*noise.add_vector('angular_rate', (0.0,) * 3), noise.add('velocity_down', 0.0)]
    gauss = random.Random('noise 7').gauss
    assert drawn == [gauss(0.0, 0.5), gauss(0.0, 0.5), gauss(0.0, 0.5), gauss(0.0, 2.0)]


@pytest.mark.parametrize(('parse', 'text', 'says'), [
    (parse_deviation, 'force=1', "no quantity 'force', only specific_force"),
    (parse_deviation, 'attitude', "noise of attitude is ''"),
    (parse_deviation, 'attitude=-1', 'at least 0'),
    (parse_bias, 'attitude=1', '3 components, not 1'),
    (parse_bias, 'attitude=1,2,much', "is 'much'"),
    (parse_bias, 'attitude=1,2,nan', "is 'nan'"),
])
def test_an_invalid_text_is_rejected(parse, text, says):
    """The error is one sentence."""
    with pytest.raises(ValueError, match=says):
        parse(text)
