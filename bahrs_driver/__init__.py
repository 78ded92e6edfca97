# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""ROS 2 driver for the BAHRS and Titan-M sensors of unmanned aircraft."""

__version__ = '0.1.0'
