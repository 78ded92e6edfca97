# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The topic `integrity`: every change of a signal's integrity, with the stamp of the sample.

Each notice has the present state of all signals: the last one is enough for a late subscriber, and
all of them together give the integrity of every sample in a bag.
"""

from collections.abc import Sequence

from bahrs_driver.convert import values
from bahrs_driver.convert.values import DiagnosticArray, DiagnosticStatus, KeyValue
from bahrs_driver.protocol.integrity import Health, Integrity
from bahrs_driver.units import NS_PER_S

LEVELS = {Integrity.SAFE: values.OK, Integrity.INTEGRITY_RISK: values.WARN,
          Integrity.UNAVAILABLE: values.ERROR, Integrity.RESERVED: values.ERROR,
          None: values.STALE}
NOT_HEARD = 'not_heard'
SET_BACK = NS_PER_S


class IntegrityNotice:
    """
    Stores the integrity of all signals, and returns a notice of each change.

    Stamps of notices never decrease, though some are of samples and others of the host, unless the
    clock was set back by more than SET_BACK.
    """

    def __init__(self, signals: Sequence[str]) -> None:
        self.signals: dict[str, Integrity | None] = dict.fromkeys(signals)
        self._last: dict[tuple[str, ...], Health] = {}
        self._sampled = 0           # stamp of the latest sample
        self._published = 0         # stamp of the latest notice

    def update(self, names: tuple[str, ...], health: Health, stamp_ns: int,
               frame_id: str) -> DiagnosticArray | None:
        """Update from the health of one sample; return a notice if it changed."""
        self._sampled = stamp_ns
        if self._last.get(names) == health:
            return None
        self._last[names] = health
        self.signals.update(zip(names, health))
        return self._notice(stamp_ns, frame_id)

    @property
    def known(self) -> bool:
        """Whether the state of any signal is known."""
        return any(state is not None for state in self.signals.values())

    def forget(self, stamp_ns: int, frame_id: str) -> DiagnosticArray | None:
        """
        Forget all signals; return a notice if that is a change, or the first notice.

        Its stamp is just after the latest sample, and before any later one. stamp_ns, the present
        time, applies to a stream without samples.
        """
        if self._published and not self.known:
            return None
        self._last.clear()
        self.signals.update(dict.fromkeys(self.signals))
        return self._notice(self._sampled + 1 if self._sampled else stamp_ns, frame_id)

    def _notice(self, stamp_ns: int, frame_id: str) -> DiagnosticArray:
        if stamp_ns > self._published - SET_BACK:
            stamp_ns = max(stamp_ns, self._published)
        self._published = stamp_ns
        return DiagnosticArray(stamp_ns, frame_id, tuple(
            _status(name, integrity) for name, integrity in self.signals.items()))


def _status(name: str, integrity: Integrity | None) -> DiagnosticStatus:
    label = NOT_HEARD if integrity is None else integrity.label
    return DiagnosticStatus(LEVELS[integrity], name, label, '', (KeyValue('integrity', label),))
