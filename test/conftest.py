# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: a ROS domain of their own, and this machine only."""

import os
import signal

# Domains above 101 collide with ports that the system gives away.
os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'

# A shell makes what it runs in the background deaf to SIGINT, and its children with it.
signal.signal(signal.SIGINT, signal.default_int_handler)
