# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain for one run of tests or of a benchmark."""

import contextlib
import fcntl
from itertools import chain
import os
from pathlib import Path
import tempfile

DOMAINS = range(1, 102)         # those above collide with ports that the system gives away
LOOPBACK = Path(__file__).with_name('loopback.xml')
APART = 37                      # domains from where one user begins to where the next does


def use_own_domain() -> None:
    """Keep ROS to this machine, and to a domain that nobody else uses on it."""
    os.environ['ROS_DOMAIN_ID'] = str(claim_domain())
    # The range LOCALHOST adds shared memory whatever else is set, and processes complain about
    # what others, which were killed, left there. SYSTEM_DEFAULT leaves all to the profile.
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'SYSTEM_DEFAULT'
    os.environ['FASTRTPS_DEFAULT_PROFILES_FILE'] = str(LOOPBACK)


def claim_domain() -> int:
    """Return a domain that no other run of tests on this machine has, until this one ends."""
    folder = Path(tempfile.gettempdir()) / f'bahrs_driver_domains_{os.getuid()}'
    folder.mkdir(exist_ok=True)
    # Nobody sees the claims of another user, so everybody begins elsewhere.
    first = os.getuid() * APART % len(DOMAINS)
    for number in chain(DOMAINS[first:], DOMAINS[:first]):
        claim = os.open(folder / str(number), os.O_CREAT | os.O_RDWR | os.O_CLOEXEC)
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(claim, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return number
        os.close(claim)
    raise RuntimeError(f'all {len(DOMAINS)} domains are taken, see {folder}')
