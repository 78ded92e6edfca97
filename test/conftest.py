# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: a ROS domain of their own, this machine only, nothing by chance."""

import os
from pathlib import Path
import signal
import tempfile
from types import ModuleType
from typing import Any

from hypothesis import HealthCheck, settings
from support.domain import use_own_domain

use_own_domain()

# How wide and how colourful output is must not depend on where the tests run.
os.environ['COLUMNS'] = '80'
for name in ('FORCE_COLOR', 'NO_COLOR', 'TTY_COMPATIBLE', 'TTY_INTERACTIVE'):
    os.environ.pop(name, None)

# By default, ROS writes its logs into the home directory, which may be missing.
logs = Path(tempfile.gettempdir()) / f'bahrs_driver_logs_{os.getuid()}'
logs.mkdir(exist_ok=True)
os.environ.setdefault('ROS_LOG_DIR', str(logs))

# A shell makes what it runs in the background deaf to SIGINT, and its children with it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples each time, however long the machine takes for one.
settings.register_profile('repeatable', derandomize=True, deadline=None,
                          suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('repeatable')

# A module of tests that imports one of these needs what the marker says.
MARKED_BY = {'process': {'subprocess', 'processes'}, 'ros': {'rclpy', 'processes', 'starting'}}
# And these directories, whatever they import.
DIRECTORIES = {'golden': {'unit', 'slow'}, 'lint': {'unit'}}


def pytest_collection_modifyitems(items: list[Any]) -> None:
    """Mark each test with what it needs; run first what waits, then what takes long."""
    for item in items:
        for name in markers(item.module):
            item.add_marker(name)
    items.sort(key=lambda item: [item.get_closest_marker(name) is None
                                 for name in ('process', 'slow')])


def markers(module: ModuleType) -> set[str]:
    """Return the markers of all tests in a module: those of what it imports, or unit."""
    directory = Path(str(module.__file__)).parent.name
    if directory in DIRECTORIES:
        return DIRECTORIES[directory]
    values = vars(module).values()
    imported = {value.__name__ if isinstance(value, ModuleType)
                else str(getattr(value, '__module__', '')) for value in values}
    packages = {part for name in imported for part in name.split('.')[:2]}
    return {name for name, marking in MARKED_BY.items() if packages & marking} or {'unit'}
