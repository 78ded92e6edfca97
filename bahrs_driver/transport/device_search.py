# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find a serial device by its USB properties, for hwgrep://."""

import re

from bahrs_driver.errors import DeviceNotFound
from serial.tools import list_ports


def find_device(pattern: re.Pattern[str], number: int) -> str:
    """Return the path of a device whose path, description or USB ids match, counted from 1."""
    matching = sorted(info.device for info in list_ports.comports()
                      if any(pattern.search(text or '')
                             for text in (info.device, info.description, info.hwid)))
    if len(matching) < number:
        raise DeviceNotFound
    return str(matching[number - 1])
