# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of the services that read the non-volatile memory of a BAHRS."""

from dataclasses import dataclass

from bahrs_driver.protocol.bahrs.nvm_session import PAGES, ServiceFrames
from bahrs_driver.settings.group import Group, setting


@dataclass(frozen=True)
class NvmSettings(Group):
    """Settings of the services. Each call reads them again unless they are read only."""

    page: int = setting(0, 'Page that the service ~/nvm/read_page reads.',
                        low=0, high=PAGES - 1, read_only=False)
    directory: str = setting(
        '~/bahrs_nvm', 'Directory for files of the service ~/nvm/dump. It is created if it does '
        'not exist.')
    dump_path: str = setting(
        'bahrs_nvm.bin', 'File that the service ~/nvm/dump writes or replaces: a path relative to '
        'nvm.directory, or an absolute path inside it.', read_only=False)
    enter_timeout: float = setting(
        30.0, 'Time limit for the device to enter diagnostics mode. Many devices enter it only '
        'within 0.5 s of power-on: call the service, then switch the device off and on.', 's',
        low=1.0, high=600.0, read_only=False)
    service_frames: ServiceFrames = setting(
        'auto', 'Checksum and padding of frames sent to the device. auto tries all, beginning '
        "with those of the manufacturer's tool (crc32) and of the protocol document "
        '(mpeg2_padded).', read_only=False)
