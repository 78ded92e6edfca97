# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: a ROS domain of their own, this machine only, nothing by chance."""

import signal

from domain import use_own_domain
from hypothesis import HealthCheck, settings

use_own_domain()

# A shell makes what it runs in the background deaf to SIGINT, and its children with it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples each time, however long the machine takes for one.
settings.register_profile('repeatable', derandomize=True, deadline=None,
                          suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('repeatable')
