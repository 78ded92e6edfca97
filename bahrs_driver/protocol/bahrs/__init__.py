# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode and encode BAHRS frames and messages, its NVM included."""
