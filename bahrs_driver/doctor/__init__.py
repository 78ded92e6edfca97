# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What `bahrs doctor` looks at.

`machine` reads the state of the computer from its files; `usb_port`, `listening`,
`ros_environment`, `ros_logging`, `graph` and `reports` each look at one thing and yield findings;
`commands` has the commands that they suggest.
"""
