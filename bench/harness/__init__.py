# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What all rows of `make bench` share: figures, bounds, children, the table."""
