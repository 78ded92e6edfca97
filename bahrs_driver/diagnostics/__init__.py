# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Publish the health of driver and device as diagnostic_msgs (REP-107).

One module for each task. The Updater runs them: for level and message alone after every read, and
with their values once a second.
"""
