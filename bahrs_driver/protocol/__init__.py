# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Bytes to messages and back.

Everything in this package is a function of its arguments: no port, clock, thread or ROS is
reachable from here. Wire input never raises; a caller's mistake raises ValueError.
"""
