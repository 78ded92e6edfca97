# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Settings of the user: read from the command line and files, checked, and reported if unused.

The settings themselves are the dataclasses in bahrs_driver.devices.
"""
