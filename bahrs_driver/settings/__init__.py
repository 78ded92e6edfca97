# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the user sets: read from the command line and files, checked, and none ignored in silence.

The table of what there is to set is bahrs_driver.settings.table.
"""
