# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Settings that remember which of them were read, and strategies for their values."""

from hypothesis import strategies as st


def values_of(parameter):
    """Return a strategy for the valid values of a parameter."""
    if parameter.choices:
        return st.sampled_from(parameter.choices)
    if isinstance(parameter.default, bool):
        return st.booleans()
    if isinstance(parameter.default, int):
        return st.integers(int(parameter.low), int(parameter.high))
    if isinstance(parameter.default, float):
        zero = st.just(0.0) if parameter.or_zero else st.nothing()
        # A number that is too small for all of its digits is a text to rcl.
        return zero | st.floats(parameter.low, parameter.high, allow_subnormal=False)
    return st.just(parameter.default)


class RecordedSettings(dict):
    """Settings that remember which of them were read."""

    def __init__(self, settings):
        """Take the settings."""
        super().__init__(settings)
        self.read = set()

    def __getitem__(self, name):
        """Return a setting, and remember its name."""
        self.read.add(name)
        return super().__getitem__(name)
