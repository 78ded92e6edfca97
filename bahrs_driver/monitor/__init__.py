# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The display of `bahrs monitor`.

`watch` subscribes to the topics, `topic_stats` counts the messages of each, `health` keeps the
diagnostics of the driver, `values` formats messages, `horizon` draws the attitude, `page` is the
live page of a terminal, and `tables` has plain tables and the JSON object.
"""
