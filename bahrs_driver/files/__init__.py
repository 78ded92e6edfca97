# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Writing files: complete or not at all, and only where a file is meant."""
