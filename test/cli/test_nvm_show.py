# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs nvm show`, in this process."""

import json
import struct
import zlib

from bahrs_driver.cli.main import main
from bahrs_driver.emulator.bahrs.nvm_image import example_image
import pytest

LOG = slice(80, 596)            # position and text of the assertions


def shown(capsys, tmp_path, image, *words):
    """Show an image; return exit status, output and errors."""
    (tmp_path / 'image.bin').write_bytes(image)
    status = main(['nvm', 'show', *words, str(tmp_path / 'image.bin')])
    return status, *capsys.readouterr()


def test_show_prints_no_control_characters(capsys, tmp_path):
    """This holds for any content. Erased texts are empty."""
    image = bytearray(example_image())
    image[LOG] = bytes(4) + b'a.c:3\x1b[2J\n'.ljust(512, b'\xff')
    status, text, _ = shown(capsys, tmp_path, image)
    assert '\n  a.c:3\\x1b[2J\nCAN ' in text and '\x1b' not in text
    image[LOG] = b'\xff' * 516
    assert '\n  none\nCAN ' in shown(capsys, tmp_path, image)[1]


def test_json_of_an_erased_memory(capsys, tmp_path):
    """A NaN becomes null."""
    status, text, _ = shown(capsys, tmp_path, b'\xff' * 8000, '--json')
    told = json.loads(text, parse_constant=pytest.fail)
    assert status == 1 and told['installation angles']['roll'] is None
    assert told['magnetometer']['hard_iron'] == [None] * 3


def test_an_image_with_another_format_or_size(capsys, tmp_path):
    """A warning is printed, and the content is shown."""
    version = struct.pack('<2I', 2, 0)
    image = version + struct.pack('<I', zlib.crc32(version)) + bytes(7988)
    assert 'has format 2.0, and is shown as if it had 1.1' in shown(capsys, tmp_path, image)[2]
    status, _, error = shown(capsys, tmp_path, bytes(8001))
    assert status == 1 and 'an image has 8,000 bytes' in error
