# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the driver knows of its own and the device's health, as diagnostic_msgs (REP-107).

One module for each task. A task judges (level and message, cheap enough to be asked after every
read) and tells its values. The Monitor collects them.
"""
