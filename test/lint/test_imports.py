# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Imports point inward: the contracts of import-linter in pyproject.toml hold."""

import os
from pathlib import Path
import re
import subprocess
import sys

import bahrs_driver
from bahrs_driver.devices.registry import DEVICES
import pytest

ROOT = Path(__file__).resolve().parents[2]
HEAVY = ('rclpy', 'numpy', 'serial', 'pyproj')


def test_contracts(monkeypatch):
    """No package imports one above it, no module is part of a circle, the core stays pure."""
    cli = pytest.importorskip('importlinter.cli', reason='import-linter is not installed')
    monkeypatch.chdir(ROOT)
    status = cli.lint_imports(config_filename='pyproject.toml', no_cache=True)
    assert status == cli.EXIT_STATUS_SUCCESS


@pytest.mark.parametrize('path', sorted((ROOT / 'bahrs_driver').rglob('*.py')),
                         ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_are_absolute(path):
    """No module is imported relative to another one."""
    assert not re.search(r'^\s*from \.', path.read_text(), re.MULTILINE)


def test_only_modules_of_the_public_interface_stand_in_the_root():
    """Everything else belongs to a package."""
    assert {path.name for path in (ROOT / 'bahrs_driver').glob('*.py')} == {
        '__init__.py', 'errors.py', 'units.py'}


def test_only_its_own_packages_name_a_device():
    """Everything else iterates over the registry."""
    names, labels = '|'.join(DEVICES), '|'.join(spec.label for spec in DEVICES.values())
    own = re.compile(rf'bahrs_driver/(devices/|(protocol|convert|emulator)/({names})/)')
    named = re.compile(rf'\b(protocol|convert|emulator|devices)\.({names})\b|\b({labels})\b|'
                       rf"(sensor\w*|name) ?[=!]=? ?'({names})'|\btitan_m\b")
    paths = [str(path.relative_to(ROOT)) for path in (ROOT / 'bahrs_driver').rglob('*.py')]
    assert [path for path in paths
            if not own.match(path) and named.search((ROOT / path).read_text())] == []


def test_importing_the_package_imports_neither_ros_nor_numpy():
    """A script that only decodes bytes starts fast, on a machine without ROS."""
    code = f'import sys, bahrs_driver; print([name for name in {HEAVY} if name in sys.modules])'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True,
                          env={**os.environ, 'PYTHONPATH': str(ROOT)})
    assert done.stdout == '[]\n'


def test_version():
    """The package's manifest has the version of the package."""
    manifest = (ROOT / 'package.xml').read_text()
    assert f'<version>{bahrs_driver.__version__}</version>' in manifest
