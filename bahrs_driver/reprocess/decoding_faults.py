# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Report frames of a recording on which the decoder failed."""

from collections.abc import Iterable, Iterator

from bahrs_driver.pipeline import DecodingFault, Event, Stamped
from bahrs_driver.process.printable import printable


class DecodingFaults:
    """Counts the frames whose messages are missing because of a fault of the decoder."""

    def __init__(self) -> None:
        self.count = 0
        self._first: DecodingFault | None = None

    def messages(self, events: Iterable[Event]) -> Iterator[Stamped]:
        """Yield the messages among events, and count the faults."""
        for event in events:
            if isinstance(event, Stamped):
                yield event
            elif isinstance(event, DecodingFault):
                self._first = self._first or event
                self.count += 1

    def notices(self) -> list[str]:
        """Return a sentence about the faults; an empty list if there was none."""
        if self._first is None:
            return []
        frame, error = self._first
        return [f'{self.count} frames could not be decoded, the first at byte {frame.offset} '
                f'({type(error).__name__}: {printable(error)}): this is a fault of bahrs_driver, '
                'please report it']
