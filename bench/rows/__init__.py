# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of `make bench`, one module for each group that is measured together."""
