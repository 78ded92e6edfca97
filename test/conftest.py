# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: a ROS domain of their own, this machine only, nothing by chance."""

import os
from pathlib import Path
import signal
import tempfile

from domain import use_own_domain
from hypothesis import HealthCheck, settings

use_own_domain()

# How wide and how colourful output is must not depend on where the tests run.
os.environ['COLUMNS'] = '80'
for name in ('FORCE_COLOR', 'NO_COLOR', 'TTY_COMPATIBLE', 'TTY_INTERACTIVE'):
    os.environ.pop(name, None)

# ROS keeps its logs at home unless told otherwise, and not everybody has one.
logs = Path(tempfile.gettempdir()) / f'bahrs_driver_logs_{os.getuid()}'
logs.mkdir(exist_ok=True)
os.environ.setdefault('ROS_LOG_DIR', str(logs))

# A shell makes what it runs in the background deaf to SIGINT, and its children with it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples each time, however long the machine takes for one.
settings.register_profile('repeatable', derandomize=True, deadline=None,
                          suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('repeatable')
