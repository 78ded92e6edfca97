# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert device messages to values of ROS messages, without ROS.

Axes, atmosphere and covariance are plain arithmetic; one package for each device makes values from
their results.
"""
