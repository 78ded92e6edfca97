# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: a ROS domain of their own, and this machine only."""

import signal

from domain import use_own_domain

use_own_domain()

# A shell makes what it runs in the background deaf to SIGINT, and its children with it.
signal.signal(signal.SIGINT, signal.default_int_handler)
