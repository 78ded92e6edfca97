# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Ports, and the loops that read and write them.

A Link opens one of several kinds of Channel: a serial device, a TCP connection, an RFC 2217
server. Channels raise the exceptions of the system and of pyserial; the Link turns them into a
LinkError, whose text `explain` composes. A PortReader reads a Link through a pipeline.
"""
