# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The kinds of port that a Link opens: serial devices, TCP and RFC 2217 servers.

One module for each; all of them are a Channel. They raise whatever the system and pyserial raise,
which the Link turns into sentences.
"""
