# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Integrity*: what the device says its signals are worth."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, OK, STALE, Verdict, WARN
from bahrs_driver.protocol.integrity import Integrity

LEVELS = {Integrity.SAFE: OK, Integrity.INTEGRITY_RISK: WARN,
          Integrity.UNAVAILABLE: ERROR, Integrity.RESERVED: ERROR}


class SignalsTask:
    """Watches the integrity of each signal."""

    name = 'Integrity'

    def __init__(self, signals: Mapping[str, Integrity | None],
                 stale: Callable[[float], bool] = lambda now: False) -> None:
        """
        Watch a mapping, kept up to date by its owner; None is not heard of.

        stale tells whether what was heard last is too old to count.
        """
        self._signals = signals
        self._stale = stale

    def judge(self, now: float) -> Verdict:
        """Return the worst level, and which signals are not safe."""
        troubled = [f'{name} {state.words}' for name, state in self._signals.items()
                    if state is not None and state is not Integrity.SAFE]
        known = [state for state in self._signals.values() if state is not None]
        if not known or self._stale(now):
            return Verdict(STALE, 'Nothing heard from the device')
        worst = max((LEVELS[state] for state in known), key=ord)
        return Verdict(worst, ', '.join(troubled) or 'All signals safe')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the integrity of each signal."""
        return {name: 'not heard' if state is None else state.words
                for name, state in self._signals.items()}
