# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A host clock that tests can set back, for processes that they start."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import shutil
import struct
import subprocess

import pytest
from support.shared_files import shared_file


class SettableClock:
    """The offset of CLOCK_REALTIME in every process that is started with `environment`."""

    def __init__(self, folder: Path) -> None:
        """Build the library that is loaded first; skip the test where that cannot be done."""
        compiler = shutil.which('gcc') or shutil.which('cc')
        if compiler is None:
            pytest.skip('there is no C compiler to build the clock that can be set back with')
        source, library = shared_file('cases/set_clock.c'), folder / 'set_clock.so'
        subprocess.run([compiler, '-shared', '-fPIC', '-o', library, source, '-ldl'], check=True)
        self._offset = folder / 'offset'
        self.set_back(0.0)
        self.environment = {'LD_PRELOAD': str(library), 'CLOCK_OFFSET_FILE': str(self._offset)}

    def set_back(self, seconds: float) -> None:
        """Set the clock back, also of processes that run already."""
        data = struct.pack('<q', -round(seconds * 1e9))
        if not self._offset.exists():
            self._offset.write_bytes(data)
        with self._offset.open('r+b') as file:          # the file is mapped: it must stay
            os.pwrite(file.fileno(), data, 0)

    @contextlib.contextmanager
    def used(self) -> Iterator['SettableClock']:
        """Let processes that are started within the block have this clock."""
        with pytest.MonkeyPatch.context() as patch:
            for name, value in self.environment.items():
                patch.setenv(name, value)
            yield self
