# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The machine and the versions that a run depends on."""

from importlib.metadata import version
import os
from pathlib import Path
import platform
import shutil
import subprocess
import time

PACKAGES = ('ros-jazzy-rclpy', 'ros-rmw-fastrtps-cpp', 'ros-fastrtps', 'numpy')


def conditions(peers: Path) -> dict[str, str]:
    """Return what the figures of this run depend on, by name; peers is the Python of the peers."""
    load = ', '.join(f'{value:.1f}' for value in os.getloadavg())
    return {
        'date': time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime()),
        'machine': f'{processor()}, {os.cpu_count()} cores, {memory():.0f} GB of memory',
        'load before the run': f'{load} (1, 5, 15 minutes)',
        'kernel': f'{platform.system()} {platform.release().split("-")[0]}',
        'Python': platform.python_version(),
        'packages': ', '.join(f'{name} {version(name)}' for name in PACKAGES),
        'peers': ', '.join(_lines(
            str(peers), '-c', 'from importlib.metadata import version\n'
            'for name in ("pyubx2", "pymavlink"): print(name, version(name))')),
        'C compiler': _lines('cc', '--version')[0] if shutil.which('cc') else 'none'}


def processor() -> str:
    """Return the name of the processor."""
    for line in Path('/proc/cpuinfo').read_text().splitlines():
        if line.startswith('model name'):
            return line.split(':')[1].strip()
    return platform.machine()


def memory() -> float:
    """Return the size of the memory in GB (10^9 bytes)."""
    return os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 1e9


def _lines(*words: str) -> list[str]:
    """Return the lines that a program prints."""
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
