# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Estimate the offset and rate of a device clock against a host clock."""
