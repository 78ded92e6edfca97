# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `driver_node`: it handles signals before its imports, which take a second or two."""

from typing import NoReturn

from bahrs_driver.shutdown_event import end_process, ShutdownEvent


def main() -> NoReturn:
    """Run the node until a signal ends it; exit with status 0, or 1 if it cannot start."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    shutdown.limit_exit_time()
    from bahrs_driver.node_process import run
    end_process(run(shutdown))
