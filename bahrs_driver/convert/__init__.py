# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device messages to ROS messages.

Axes, atmosphere, covariance and pairing are plain arithmetic; one module for each device puts
their results into sensor_msgs and its relatives.
"""
