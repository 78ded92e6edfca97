# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert device messages to ROS messages.

Axes, atmosphere and covariance are plain arithmetic; one package for each device builds messages
from their results.
"""
