# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Whether ROS can log, and write its log files."""

from collections.abc import Iterator, Mapping
from pathlib import Path
import shlex
import tempfile

from bahrs_driver.doctor.finding import advice, Finding, good, problem
from bahrs_driver.ros.start import log_directory, log_problem, SWITCHES


def look(environment: Mapping[str, str]) -> Iterator[Finding]:
    """Yield what the variables of an environment mean for the logs."""
    for name in SWITCHES:
        if environment.get(name, '') not in ('', '0', '1'):
            yield problem('logging', f"{name} is '{environment[name]}': it must be 0 or 1",
                          f'unset {name}')
    reason = log_problem(environment)
    if reason:
        folder = Path(tempfile.gettempdir()) / 'ros_logs'
        yield advice('log files', f'nodes write none: {reason}',
                     f'export ROS_LOG_DIR={shlex.quote(str(folder))}')
    else:
        yield good('log files', f'go to {log_directory(environment)}')
