# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Recognize the files of a bag, without the libraries that read them."""

from pathlib import Path

MCAP_MAGIC = b'\x89MCAP0\r\n'
SQLITE_MAGIC = b'SQLite format 3\0'
ZSTD_MAGIC = b'\x28\xb5\x2f\xfd'
HEAD_SIZE = 16                          # bytes that contain any of them

KINDS = ('.mcap', '.db3')
COMPRESSIONS = ('', '.zstd', '.zst')    # suffixes that rosbag2 and zstd add
SUFFIXES = tuple(kind + compression for kind in KINDS for compression in COMPRESSIONS)


def is_bag(path: Path) -> bool:
    """Return whether a path names a bag, by its name or its first bytes; may raise OSError."""
    if path.is_dir() or path.name.endswith(SUFFIXES):
        return True
    if not path.is_file():              # a pipe, whose bytes can be read only once
        return False
    with path.open('rb') as file:
        return file.read(HEAD_SIZE).startswith((MCAP_MAGIC, SQLITE_MAGIC, ZSTD_MAGIC))


def base_name(file: Path) -> str:
    """Return the name of a file without the suffixes of its kind and compression."""
    suffix = next((suffix for suffix in reversed(SUFFIXES) if file.name.endswith(suffix)), '')
    return file.name.removesuffix(suffix)
