# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `driver_node`: it heeds signals first, for what it imports takes a second or two."""

import signal

from bahrs_driver.ending import Ending


def main() -> int:
    """Run the node until a signal ends it; the exit status is not 0 if it could not start."""
    ended = Ending()
    ended.listen_to(signal.SIGINT, signal.SIGTERM)
    from bahrs_driver.node import run
    return run(ended)
