# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The display of `bahrs monitor`.

`watch` subscribes to the topics, `topic_stats` counts the messages of each, `health` keeps the
diagnostics of the driver, `values` formats messages, `hints` has advice if no driver is found,
`horizon` draws the attitude, `page` draws the live page of a terminal, and `tables` makes plain
tables and the JSON object.
"""
