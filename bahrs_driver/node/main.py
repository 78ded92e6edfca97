# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `driver_node`. It handles signals before its imports, which take a second."""

import sys
from typing import NoReturn

from bahrs_driver.errors import RosStartError
from bahrs_driver.process.shutdown_event import end_process, ShutdownEvent
from bahrs_driver.process.standard_streams import replace_closed_streams
from bahrs_driver.ros.start import check_import, missing_module


def main() -> NoReturn:
    """Run the node until a signal; exit with status 0, or 1 if it cannot start."""
    replace_closed_streams()
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    shutdown.limit_exit_time()
    try:
        check_import()
        from bahrs_driver.node.process import run
    except (RosStartError, ImportError) as error:
        reason = missing_module(error) if isinstance(error, ImportError) else error
        print('bahrs_driver:', reason, file=sys.stderr)
        end_process(1)
    end_process(run(shutdown))
