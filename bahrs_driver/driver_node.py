# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `driver_node`: it handles signals before its imports, which take a second or two."""

from bahrs_driver.shutdown_event import ignore_signals, ShutdownEvent


def main() -> int:
    """Run the node until a signal ends it; return 0, or 1 if it cannot start."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    shutdown.limit_exit_time()
    from bahrs_driver.node_process import run
    status = run(shutdown)
    ignore_signals()
    return status
