# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read and write rosbag2 bags, and record the topics of a driver into one."""
