# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain for one run of tests or of a benchmark."""

import os
from pathlib import Path
import socket

DOMAINS = range(1, 102)         # those above collide with ports that the system gives away
LOOPBACK = Path(__file__).with_name('loopback.xml')
_claims: list[socket.socket] = []       # held until this process ends


def use_own_domain() -> None:
    """Keep ROS to this machine, and to a domain that nobody else uses on it."""
    os.environ['ROS_DOMAIN_ID'] = str(claim_domain())
    # The range LOCALHOST adds shared memory whatever else is set, and processes complain about
    # what others, which were killed, left there. SYSTEM_DEFAULT leaves all to the profile.
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'SYSTEM_DEFAULT'
    os.environ['FASTRTPS_DEFAULT_PROFILES_FILE'] = str(LOOPBACK)


def claim_domain() -> int:
    """
    Return a domain that no other run on this machine has, until this one ends.

    A claim is a name of an abstract socket: it is the same for all users and temporary
    directories, and like the loopback interface it belongs to the network namespace.
    """
    for number in DOMAINS:
        claim = socket.socket(socket.AF_UNIX)
        try:
            claim.bind(f'\0bahrs_driver_domain_{number}')
        except OSError:
            claim.close()
            continue
        _claims.append(claim)
        return number
    raise RuntimeError(f'all {len(DOMAINS)} domains are taken')
