# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Property tests: reading a bag with any content returns chunks or raises CaptureError."""

import functools
from pathlib import Path
import tempfile

from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.bag.read_metadata import END_OF_TIME
from bahrs_driver.errors import CaptureError
from hypothesis import example, given, settings, strategies as st
import pytest
from support.bags import every_form

EXAMPLES = 150
FORMS = ['LZ4.mcap', 'MCAP_FILE.mcap.zstd', 'MCAP_MESSAGE.mcap', 'MCAP_NONE.mcap',
         'MCAP_STORAGE.mcap', 'NONE.mcap', 'SQLITE3_FILE.db3.zstd', 'SQLITE3_MESSAGE.db3',
         'SQLITE3_NONE.db3', 'ZSTD.mcap']
MAGICS = (b'\x89MCAP0\r\n', b'SQLite format 3\0', b'\x28\xb5\x2f\xfd')
# Lengths and counts that a reader may believe, as they stand in MCAP, CDR and SQLite.
NUMBERS = [number.to_bytes(size, order) for number in (0, 1, 22, 0x7fffffff, 0xffffffff)
           for size in (4, 8) for order in ('little', 'big')] + [b'\xff' * 8, b'\xff' * 9]


@functools.cache
def bags():
    """Return the content of a file of each form of bag, by name."""
    with tempfile.TemporaryDirectory() as folder:
        return {file.name: file.read_bytes() for file in every_form(Path(folder))}


def read(name, content):
    """Read a file, and check its chunks, its notes or its error."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / name
        file.write_bytes(content)
        try:
            capture = open_capture(file)
            chunks = list(capture.chunks())
        except CaptureError as error:
            assert str(error).isprintable() and str(file) in str(error)
            return
        assert all(note.isprintable() for note in capture.notes)
        assert capture.done == capture.size == len(content)
        for chunk in chunks:
            assert isinstance(chunk, Chunk) and 0 <= chunk.ros_ns < END_OF_TIME


@st.composite
def changes(draw):
    """Return some changes: place (as a share of the file), bytes, and whether they overwrite."""
    piece = st.one_of(st.binary(max_size=12), st.sampled_from(NUMBERS))
    return [(draw(st.floats(0, 1)), draw(piece), draw(st.booleans()))
            for _ in range(draw(st.integers(1, 6)))]


def test_every_form_is_damaged():
    """The names are written out because making the bags takes a second."""
    assert sorted(FORMS) == sorted(bags())


@pytest.mark.parametrize('name', FORMS)
@settings(max_examples=EXAMPLES)
@given(changes=changes(), kept=st.one_of(st.just(1.0), st.floats(0, 1)))
def test_damaged_bags(name, changes, kept):
    """Bytes are changed, inserted, or cut off."""
    content = bytearray(bags()[name])
    for share, piece, over in changes:
        place = round(share * len(content))
        content[place:place + len(piece) * over] = piece
    read(name, bytes(content[:round(kept * len(content))]))


@pytest.mark.parametrize('suffix', ['.mcap', '.db3', '.mcap.zstd', '.db3.zstd', '.bag'])
@settings(max_examples=EXAMPLES)
@given(magic=st.sampled_from(MAGICS), content=st.binary(max_size=300))
@example(magic=b'', content=b'')
def test_bytes_of_any_kind(suffix, magic, content):
    """They follow the first bytes of a bag."""
    read(f'bag{suffix}', magic + content)


@settings(max_examples=EXAMPLES)
@given(records=st.lists(st.tuples(
    st.integers(0, 20), st.one_of(st.binary(max_size=60), st.sampled_from(NUMBERS)),
    st.one_of(st.none(), st.integers(0, 2 ** 64 - 1)))))
def test_records_of_any_kind(records):
    """Records have any content, and some a wrong length."""
    content = MAGICS[0]
    for kind, body, claim in records:
        content += bytes([kind]) + (len(body) if claim is None else claim).to_bytes(8, 'little')
        content += body
    read('bag.mcap', content)
