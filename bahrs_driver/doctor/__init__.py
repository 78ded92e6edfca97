# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The checks of `bahrs doctor`.

The modules `usb_port`, `listening`, `ros_environment`, `graph` and `driver_health` each check one
subject and yield results; `commands` builds the commands that they suggest.
"""
