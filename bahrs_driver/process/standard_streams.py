# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Replace standard streams that the parent process has closed.

The next file that is opened would take the number of a closed stream. Then log lines would go to a
serial port, or to the pipe that ends the program.
"""

import os
import sys

_MODES = {'stdin': 'r', 'stdout': 'w', 'stderr': 'w'}


def replace_closed_streams() -> None:
    """Open closed streams on /dev/null. Call it before any file is opened."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) < len(_MODES):
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    for number, (name, mode) in enumerate(_MODES.items()):
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, mode, closefd=False))
