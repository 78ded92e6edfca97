# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What a device sent: kept, read again, and made into topics.

`origin` is what the topic `raw` says of a read. `capture` reads byte files, and bags that hold
`raw` by means of `bag_input`: `bag_kind` tells them apart, `bag_files` opens them, `mcap_input`
and `sqlite_input` read their messages, with `compression` and `damage`. `bag_output` writes bags,
out of `topics`, `metadata` and `sealed_file`, and `recorder` listens to a node. `conversion` makes
topics of a capture, with `log_clock` for even log times and `flight_health` for the diagnostics,
and writes into `outputs`, with `serialization`. For a capture without times, `byte_times` takes
those of the device: `counted_stream` counts its samples, `sample_times` has their times, and
`byte_clock` stamps by them.
`message_times` has device times for messages that are only decoded.
"""
