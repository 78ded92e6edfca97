# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The checks of `bahrs doctor`.

`usb_port`, `listening`, `ros_environment`, `graph` and `reports` each check one thing and yield
results; `commands` has the commands that they suggest.
"""
