# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Start rclpy, run callbacks and select nodes, for the node and the tools."""
