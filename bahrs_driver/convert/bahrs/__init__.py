# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Convert BAHRS messages to values of ROS messages."""
