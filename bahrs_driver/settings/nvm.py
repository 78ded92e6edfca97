# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of the services that read a non-volatile memory."""

from dataclasses import dataclass
from typing import Literal

from bahrs_driver.settings.group import Group, setting


@dataclass(frozen=True)
class Nvm(Group):
    """Settings of the services, which read them again at each call unless they are read only."""

    page: int = setting(0, 'Page that the service ~/nvm/read_page reads.', low=0, high=249,
                        read_only=False)
    directory: str = setting(
        '~/bahrs_nvm', 'Directory that the service ~/nvm/dump may write into; made when missing.')
    dump_path: str = setting(
        'bahrs_nvm.bin', 'File that the service ~/nvm/dump writes or replaces: relative to '
        'nvm.directory, or absolute inside it.', read_only=False)
    enter_timeout: float = setting(
        30.0, 'How long to ask the device to enter diagnostics mode. Many do so only within 0.5 s '
        'of power-on: call the service, then switch the device off and on.', 's',
        low=1.0, high=600.0, read_only=False)
    service_frames: Literal['auto', 'crc32', 'mpeg2', 'crc32_padded', 'mpeg2_padded'] = setting(
        'auto', 'Checksum and padding of frames to the device: auto tries all, first those of the '
        "manufacturer's tool (crc32), then those of the document (mpeg2_padded).", read_only=False)
