# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The linters of ROS, and mypy, as tests."""

from importlib.metadata import version
from pathlib import Path
import subprocess
import sys

from ament_flake8.main import main_with_errors
from ament_pep257.main import main as pep257
import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [str(ROOT / name)
           for name in ('bahrs_driver', 'bench', 'launch', 'test', 'tools', 'setup.py')]


# Python 3.12 has tokens inside an f-string, which older flake8-quotes take for strings.
QUOTES_IN_F_STRINGS = (sys.version_info >= (3, 12)
                       and version('flake8-quotes').split('.') < ['3', '4'])


def test_flake8():
    """Style, quotes, unused names, import order."""
    _, errors = main_with_errors(argv=SOURCES)
    errors = [error for error in errors if not (QUOTES_IN_F_STRINGS and ' Q000 ' in error)]
    assert errors == [], '\n'.join(errors)


def test_pep257():
    """Docstrings."""
    assert pep257(argv=SOURCES) == 0


def test_mypy():
    """Strict types, as the oldest Python that is supported sees them."""
    done = subprocess.run([sys.executable, '-m', 'mypy', 'bahrs_driver', 'test/support'],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_ruff():
    """Unused arguments, private members of others, complexity: the rules in pyproject.toml."""
    done = subprocess.run([sys.executable, '-m', 'ruff', 'check', 'bahrs_driver'],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    if 'No module named' in done.stderr:
        pytest.skip('ruff is not installed')
    assert done.returncode == 0, done.stdout + done.stderr
