# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Lay out values as serialized ROS messages (CDR)."""
