# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The troposphere of the International Standard Atmosphere (ISO 2533), below 11,000 m.

A pressure height is by definition the height at which the standard atmosphere has the measured
static pressure, so the pressure follows from it exactly, in any weather.
"""

from bahrs_driver.units import STANDARD_GRAVITY

SEA_LEVEL_PRESSURE = 101325.0       # Pa
SEA_LEVEL_TEMPERATURE = 288.15      # K
LAPSE_RATE = 0.0065                 # K/m
GAS_CONSTANT = 287.05287            # J/(kg K), of dry air

_EXPONENT = STANDARD_GRAVITY / (GAS_CONSTANT * LAPSE_RATE)


def pressure(height: float) -> float:
    """Return the static pressure in Pa at a pressure height in m."""
    temperature_ratio = 1 - LAPSE_RATE * height / SEA_LEVEL_TEMPERATURE
    return float(SEA_LEVEL_PRESSURE * temperature_ratio ** _EXPONENT)


def pressure_height(static_pressure: float) -> float:
    """Return the pressure height in m of a static pressure in Pa."""
    temperature_ratio = (static_pressure / SEA_LEVEL_PRESSURE) ** (1 / _EXPONENT)
    return float((1 - temperature_ratio) * SEA_LEVEL_TEMPERATURE / LAPSE_RATE)


def density(height: float) -> float:
    """Return the density of the air in kg/m^3 at a pressure height in m."""
    return pressure(height) / (GAS_CONSTANT * (SEA_LEVEL_TEMPERATURE - LAPSE_RATE * height))


def pressure_gradient(height: float) -> float:
    """Return the change of static pressure with height, in Pa/m (negative)."""
    temperature = SEA_LEVEL_TEMPERATURE - LAPSE_RATE * height
    return -pressure(height) * STANDARD_GRAVITY / (GAS_CONSTANT * temperature)
