# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read control commands from a terminal or a pipe."""

import os

_READ_SIZE = 4096


class ControlInput:
    """Reads lines from a descriptor without blocking. At the end `descriptor` becomes None."""

    def __init__(self, descriptor: int | None) -> None:
        self.descriptor = descriptor
        self._incomplete_line = b''

    def read_lines(self) -> list[str]:
        """Return the lines that are complete. The descriptor must be readable."""
        if self.descriptor is None:
            return []
        try:
            data = os.read(self.descriptor, _READ_SIZE)
        except OSError:         # a terminal whose foreground process is another one
            data = b''
        *lines, self._incomplete_line = (self._incomplete_line + data).split(b'\n')
        if not data:
            self.descriptor = None
            lines.append(self._incomplete_line)
        return [line.decode(errors='replace') for line in lines]
