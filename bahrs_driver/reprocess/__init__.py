# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Regenerate all topics from recorded raw bytes, with the time of the whole recording."""
