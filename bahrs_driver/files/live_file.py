# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Text files that other programs read while they grow."""

import os
import stat

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import check_target, guard, guard_new, named_target, PathLike
from bahrs_driver.process.printable import printable

# Opening must not block if a FIFO has just replaced the file.
_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_MODE = 0o666               # less what the umask takes


class LiveFile:
    """A regular file that has its final name from the start. All methods raise WriteError."""

    def __init__(self, path: PathLike, replace: bool = False) -> None:
        self._path = path
        directory, name = named_target(path)
        target = os.path.join(directory, name)
        check_target(target, path, replace)
        with guard_new(path):
            descriptor = os.open(target, _FLAGS | (0 if replace else os.O_EXCL), _MODE)
            self._file = os.fdopen(descriptor, 'w', encoding='utf-8')
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                self._file.close()
                raise WriteError(f'cannot write {printable(path)}: it is not a regular file any '
                                 'more')
            os.ftruncate(descriptor, 0)

    def write(self, text: str) -> None:
        """Append a text."""
        with guard(self._path):
            self._file.write(text)

    def flush(self) -> None:
        """Make the text visible to other programs."""
        with guard(self._path):
            self._file.flush()

    def close(self) -> None:
        """Flush and close the file."""
        with guard(self._path):
            self._file.close()
