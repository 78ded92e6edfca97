# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run a program; write its processor time in s and peak memory in MB into a file descriptor."""

import os
import sys


def main() -> int:
    """Return the exit status of the program."""
    result, *words = sys.argv[1:]
    child = os.fork()
    if not child:
        os.execvp(words[0], words)
    _, status, used = os.wait4(child, 0)
    figures = f'[{used.ru_utime + used.ru_stime}, {used.ru_maxrss * 1024 / 1e6}]'
    os.write(int(result), figures.encode())
    return os.waitstatus_to_exitcode(status)


if __name__ == '__main__':
    sys.exit(main())
