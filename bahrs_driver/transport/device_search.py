# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Serial devices by what USB knows of them, as hwgrep:// names them."""

import re

from bahrs_driver.errors import DeviceNotFound
from serial.tools import list_ports


def find_device(pattern: re.Pattern[str], turn: int) -> str:
    """Return the path of the turn-th device whose path, description or USB ids match."""
    matching = sorted(info.device for info in list_ports.comports()
                      if any(pattern.search(text or '')
                             for text in (info.device, info.description, info.hwid)))
    if len(matching) < turn:
        raise DeviceNotFound
    return str(matching[turn - 1])
