# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Publish the health of driver and device as diagnostic_msgs (REP-107).

Each task has a module. The Updater runs all tasks after every read for their level and message,
and once a second also for their values.
"""
