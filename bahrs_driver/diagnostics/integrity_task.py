# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Integrity*: the integrity that the device reports for each signal."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, NO_DATA, OK, Status, Template, WARN
from bahrs_driver.protocol.integrity import Integrity

UNAVAILABLE = Template(ERROR, '{signals}', 'an unavailable signal')
AT_RISK = Template(WARN, '{signals_at_risk}', 'a signal at integrity risk')
SAFE = Template(OK, 'All signals safe')


class IntegrityTask:
    """
    Watches the integrity of each signal, None before it is received.

    The owner of the mapping keeps it up to date. stale returns whether no data arrives.
    """

    name = 'Integrity'
    messages = UNAVAILABLE, AT_RISK, NO_DATA, SAFE

    def __init__(self, signals: Mapping[str, Integrity | None],
                 stale: Callable[[float], bool] = lambda _: False) -> None:
        self._signals = signals
        self._stale = stale

    def run(self, status: Status) -> Status:
        """Report the worst level, and which signals are not safe."""
        status.values_from(self._values)
        known = {name: state for name, state in self._signals.items() if state is not None}
        if not known or self._stale(status.now):
            return status.summary(NO_DATA)
        if set(known.values()) == {Integrity.SAFE}:
            return status.summary(SAFE)
        unsafe = ', '.join(f'{name} {state.words}' for name, state in known.items()
                           if state is not Integrity.SAFE)
        if not all(state.available for state in known.values()):
            return status.summary(UNAVAILABLE, signals=unsafe)
        return status.summary(AT_RISK, signals_at_risk=unsafe)

    def _values(self, _now: float) -> Mapping[str, str]:
        return {name: 'not received' if state is None else state.words
                for name, state in self._signals.items()}
