# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What every process of this package needs: signals, exit, standard streams, host time."""
