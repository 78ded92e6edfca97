# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What `bahrs monitor` knows and draws.

`watch` listens to the topics, `tally` counts what comes on each, `health` keeps the diagnostics of
the driver that is watched, `values` reads what is in their messages, `horizon` draws the
attitude, `page` is the live page of a terminal, `tables` the plain one, `record` the same for
programs.
"""
