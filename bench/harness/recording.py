# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Files that rows share, in the folder .bench, which `make clean` removes."""

from pathlib import Path
import sys

from harness.child import output

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / '.bench'
BAHRS = Path(sys.executable).with_name('bahrs')
FULL, PART = 11_640, 1_164      # s of an emulated BAHRS at full rates: 100 MB and 10 MB


def recording(duration: int = FULL) -> Path:
    """Return a recording of raw bytes, without damage; emulate it if it does not exist."""
    path = FOLDER / f'bahrs_{duration}_s.bin'
    if not path.exists():
        FOLDER.mkdir(exist_ok=True)
        output(BAHRS, 'emulate', '--output', path, '--duration', str(duration))
    return path


def megabytes(path: Path) -> float:
    """Return the size of a file in MB (10^6 bytes)."""
    return path.stat().st_size / 1e6
