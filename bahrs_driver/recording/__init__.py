# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What a device sent: kept, read again, and made into topics.

`origin` is what the topic `raw` says of a read. `capture` reads byte files, and bags that hold
`raw` by means of `bag_input`: `bag_kind` tells them apart, `bag_files` opens them, `mcap_input`
and `sqlite_input` read their messages, with `compression` and `damage`. `bag_output` writes bags,
out of `topics`, `metadata` and `sealed_file`, and `recorder` listens to a node. `conversion` makes
topics of a capture, with `byte_times` for one without times, `log_clock` for even log times and
`flight_health` for the diagnostics, and writes into `outputs`, with `serialization`.
`message_times` has device times for messages that are only decoded.
"""
