# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tables: the messages of each topic as columns, in memory and in files."""
