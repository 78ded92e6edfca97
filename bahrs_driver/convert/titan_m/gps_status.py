# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the GPS of a Titan-M has a fix."""

from typing import NamedTuple


class GpsStatus(NamedTuple):
    """The latest GPS answer, if there was one: with a position in a UTM zone, or without."""

    received: bool = False
    zone: int = 0           # 0 without a fix
    northern: bool = True

    @property
    def lacks_fix(self) -> bool:
        """Whether the GPS reports that it has no position."""
        return self.received and not self.zone

    def __str__(self) -> str:
        """Return the status as text."""
        if not self.received:
            return 'not received'
        if not self.zone:
            return 'no fix'
        return f"fix in zone {self.zone} {'north' if self.northern else 'south'}"
