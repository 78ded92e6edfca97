# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The linters of ROS, and mypy, as tests."""

from pathlib import Path
import subprocess
import sys

from ament_flake8.main import main_with_errors
from ament_pep257.main import main as pep257

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [str(ROOT / name)
           for name in ('bahrs_driver', 'bench', 'launch', 'test', 'tools', 'setup.py')]


def test_flake8():
    """Style, quotes, unused names, import order."""
    status, errors = main_with_errors(argv=SOURCES)
    assert status == 0, '\n'.join(errors)


def test_pep257():
    """Docstrings."""
    assert pep257(argv=SOURCES) == 0


def test_mypy():
    """Strict types, as the oldest Python that is supported sees them."""
    done = subprocess.run([sys.executable, '-m', 'mypy', 'bahrs_driver'],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
