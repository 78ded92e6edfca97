# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests that rates, attitude, forces, velocity and height of a motion agree."""

import math

from bahrs_driver.emulator.flights import AIRFIELD, FLIGHT, Flight, MOTIONS, SteadyTurn, Still
from bahrs_driver.emulator.motion import Profile, Steps
from bahrs_driver.units import STANDARD_GRAVITY
import numpy as np
import pytest

MOVING = [Flight(), SteadyTurn()]
FLIGHT_TIME = Flight().duration


def rotation(truth):
    """Return the matrix from body axes to north, east, down, by the textbook."""
    cr, sr = math.cos(truth.roll), math.sin(truth.roll)
    cp, sp = math.cos(truth.pitch), math.sin(truth.pitch)
    cy, sy = math.cos(truth.heading), math.sin(truth.heading)
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def turned(matrix, rate, duration):
    """Return an attitude after a constant rate about the body axes (Rodrigues)."""
    x, y, z = np.asarray(rate) * duration
    angle = math.sqrt(x * x + y * y + z * z)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if angle < 1e-12:
        return matrix
    return matrix @ (np.eye(3) + math.sin(angle) / angle * cross
                     + (1 - math.cos(angle)) / angle ** 2 * cross @ cross)


@pytest.mark.parametrize('motion', MOVING, ids=lambda motion: type(motion).__name__)
def test_integrating_the_rates_gives_the_attitude(motion):
    """Over six minutes of taxi, take-off, climb and turns, to 1e-4 rad."""
    step, worst = 0.01, 0.0
    attitude = rotation(motion.at(0.0))
    for index in range(36_000):
        attitude = turned(attitude, motion.at((index + 0.5) * step).angular_rate, step)
        if index % 1000 == 999:
            difference = attitude.T @ rotation(motion.at((index + 1) * step))
            worst = max(worst, np.abs(difference - np.eye(3)).max())
    assert worst < 1e-4


@pytest.mark.parametrize('motion', [*MOVING, Still()],
                         ids=lambda motion: type(motion).__name__)
def test_the_forces_fit_velocity_and_gravity(motion):
    """Specific force is the derivative of velocity, less gravity, in body axes."""
    step = 1e-3
    for time in np.arange(0.5, FLIGHT_TIME - 0.5, 0.7):
        truth = motion.at(time)
        acceleration = (np.array(motion.at(time + step).velocity)
                        - np.array(motion.at(time - step).velocity)) / (2 * step)
        force = rotation(truth).T @ (acceleration - (0, 0, STANDARD_GRAVITY))
        assert np.abs(force - truth.specific_force).max() < 1e-4


def test_the_height_fits_the_vertical_velocity():
    """And the integral is exact over the whole flight."""
    flight, step = Flight(), 1e-3
    for time in np.arange(0.5, FLIGHT_TIME - 0.5, 0.7):
        climb = (flight.at(time + step).pressure_height
                 - flight.at(time - step).pressure_height) / (2 * step)
        assert climb == pytest.approx(-flight.at(time).velocity_down, abs=1e-5)
        assert flight.at(time).velocity_down == flight.at(time).velocity[2]


def test_motion_is_continuous():
    """No quantity jumps between samples, nor at the end of the flight."""
    flight = Flight()
    for time in [phase_end(index) for index in range(len(FLIGHT))]:
        before, after = flight.at(time - 1e-6), flight.at(time + 1e-6)
        for a, b in zip(flat(before), flat(after)):
            assert abs(math.remainder(a - b, 2 * math.pi)) < 1e-4


def phase_end(index):
    """Return when a phase of the flight ends, in seconds."""
    return sum(phase.duration for phase in FLIGHT[:index + 1])


def flat(truth):
    """Return every number of a truth."""
    return [number for item in truth
            for number in (item if isinstance(item, tuple) else (item,))]


def test_the_flight_covers_heights_banks_and_headings():
    """It climbs to 6,000 m, banks both ways, and passes north and south both ways."""
    truths = [Flight().at(time) for time in np.arange(0.0, FLIGHT_TIME, 0.1)]
    heights = [truth.pressure_height for truth in truths]
    assert max(heights) == pytest.approx(6000.0)
    assert min(heights) == pytest.approx(AIRFIELD)
    rolls = [math.degrees(truth.roll) for truth in truths]
    assert min(rolls) < -30 and max(rolls) > 30 and max(map(abs, rolls)) < 60
    steps = [(a.heading, b.heading) for a, b in zip(truths, truths[1:])]
    assert any(a > 6 and b < 0.5 for a, b in steps) and any(a < 0.5 and b > 6 for a, b in steps)
    assert any(a < math.pi <= b for a, b in steps) and any(b < math.pi <= a for a, b in steps)
    assert all(0 <= truth.heading < 2 * math.pi for truth in truths)


def test_the_flight_ends_as_it_began():
    """The next flight follows without a jump, for hours."""
    start = Flight().at(0.0)
    for end in (Flight().at(FLIGHT_TIME - 1e-9), Flight().at(7 * FLIGHT_TIME)):
        assert flat(end) == pytest.approx(flat(start), abs=1e-6)


def test_the_motion_is_soon_visible():
    """The heading changes within 15 s, the bank within two minutes."""
    flight = Flight()
    assert abs(math.remainder(flight.at(15.0).heading - flight.at(0.0).heading, 2 * math.pi)) > 0.5
    assert max(flight.at(time).roll for time in range(120)) > math.radians(25)


def test_the_vehicle_at_rest_feels_gravity_only():
    """Forward, right, down: the ground pushes upward."""
    truth = Still(height=100.0, heading=90.0).at(12.3)
    assert truth.specific_force == (0.0, 0.0, -STANDARD_GRAVITY)
    assert truth.angular_rate == (0.0, 0.0, 0.0)
    assert (truth.roll, truth.pitch, truth.pressure_height) == (0.0, 0.0, 100.0)
    assert truth.heading == pytest.approx(math.pi / 2)


def test_a_coordinated_turn_has_no_lateral_force():
    """Bank by v*omega/g, the load along the body's down axis."""
    truth = SteadyTurn().at(10.0)
    turn = SteadyTurn.SPEED * SteadyTurn.TURN_RATE
    assert truth.roll == pytest.approx(math.atan2(turn, STANDARD_GRAVITY))
    assert truth.specific_force == pytest.approx(
        (0, 0, -math.hypot(turn, STANDARD_GRAVITY)), abs=1e-12)


def test_a_profile_is_exact():
    """Halfway through a step a smoothstep is halfway up, at its steepest."""
    steps = Steps([2.0, 4.0])
    assert steps.duration == 6.0
    profile = Profile(steps, 1.0, [1.0, 9.0])
    assert profile.at(*steps.find(1.0)) == (1.0, 0.0, 0.0)
    assert profile.at(*steps.find(4.0)) == pytest.approx((5.0, 8.0 * 1.875 / 4.0, 0.0))
    assert profile.at(*steps.find(6.0)) == pytest.approx((9.0, 0.0, 0.0))
    assert profile.integral(*steps.find(6.0)) == pytest.approx(2.0 + 20.0)


def test_every_motion_can_be_chosen():
    """Each motion has a name and true values at the start."""
    assert set(MOTIONS) == {'flight', 'still', 'steady-turn'}
    assert all(make().at(0.0).pressure_height > 0 for make in MOTIONS.values())
