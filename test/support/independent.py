# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A second, plain implementation of the BAHRS frame, and the streams that the tests make of it.

Nothing here comes from the code under test.
"""

from collections.abc import Callable, Iterator, Sequence
import struct

from hypothesis import assume, settings, strategies as st

# Payload sizes by (version, type), from the document and, below version 3, from the recording.
STREAM_PAYLOADS = {
    (1, 0x01): 14, (1, 0x02): 12, (1, 0x03): 15, (1, 0x04): 10, (1, 0x05): 10, (1, 0x06): 9,
    (1, 0x0F): 7,
    (2, 0x01): 14, (2, 0x02): 12, (2, 0x03): 15, (2, 0x04): 10, (2, 0x05): 10, (2, 0x06): 9,
    (2, 0x0F): 7,
    (3, 0x01): 15, (3, 0x02): 13, (3, 0x03): 15, (3, 0x04): 10, (3, 0x05): 10, (3, 0x06): 9,
    (3, 0x0F): 7, (3, 0x1F): 14,
}
SERVICE_PAYLOADS = {(version, message_type): size for version in (1, 2, 3)
                    for message_type, size in
                    ((0xF0, 0), (0xF1, 0), (0xF2, 1), (0xF3, 33), (0xFF, 2))}
HEADER_SIZE = 5
Draw = st.DrawFn
Frames = st.SearchStrategy[bytes]
LONGEST_FRAME = 44      # an NVM page, should it come padded


def properties(examples: int) -> settings:
    """Return settings for so many examples."""
    return settings(max_examples=examples)


def mpeg2(data: bytes) -> int:
    """Return the CRC-32/MPEG-2 as a number, bit by bit as the document defines it."""
    register = 0xFFFFFFFF
    for byte in data:
        register ^= byte << 24
        for _ in range(8):
            register = (register << 1 ^ (0x04C11DB7 if register >> 31 else 0)) & 0xFFFFFFFF
    return register


def mpeg2_words(data: bytes) -> int:
    """Return the CRC-32/MPEG-2 over little-endian words."""
    return mpeg2(b''.join(data[i:i + 4][::-1] for i in range(0, len(data), 4)))


def crc32(data: bytes) -> int:
    """Return the ordinary, reflected CRC-32, bit by bit."""
    register = 0xFFFFFFFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (0xEDB88320 if register & 1 else 0)
    return register ^ 0xFFFFFFFF


CHECKSUMS: dict[str, Callable[[bytes], int]] = {'word': mpeg2_words, 'byte': mpeg2, 'crc32': crc32}


def make_frame(version: int, message_type: int, payload: bytes, checksum: str = 'word',
               padded: bool = True) -> bytes:
    """Return a whole frame."""
    body = b'NE' + struct.pack('<HB', version, message_type) + payload
    if padded:
        body += bytes(4 - len(body) % 4)
    return body + struct.pack('<I', CHECKSUMS[checksum](body))


@st.composite
def stream_frames(draw: Draw, checksums: Sequence[str] = ('word', 'byte')) -> bytes:
    """Draw an intact stream frame of any version, with any payload."""
    (version, message_type), size = draw(st.sampled_from(sorted(STREAM_PAYLOADS.items())))
    payload = draw(st.binary(min_size=size, max_size=size))
    return make_frame(version, message_type, payload, draw(st.sampled_from(checksums)))


@st.composite
def service_frames(draw: Draw) -> bytes:
    """Draw an intact service frame in any of the variants that the devices and tools use."""
    (version, message_type), size = draw(st.sampled_from(sorted(SERVICE_PAYLOADS.items())))
    payload = draw(st.binary(min_size=size, max_size=size))
    padded = message_type in (0xF0, 0xF1) and draw(st.booleans())
    checksum = draw(st.sampled_from(('crc32', 'byte', 'word') if padded else ('crc32', 'byte')))
    return make_frame(version, message_type, payload, checksum, padded)


def known_frames() -> Frames:
    """Draw an intact frame of any known type."""
    return st.one_of(stream_frames(), service_frames())


@st.composite
def debug_frames(draw: Draw) -> bytes:
    """Draw an intact frame of the undocumented types 0xC0 and 0xC1, without a marker inside."""
    version = draw(st.sampled_from((1, 2, 3)))
    start = draw(st.binary(min_size=9, max_size=9))
    text = draw(st.none() | st.binary(max_size=60))
    if text is None:
        message_type, payload = 0xC1, start
    else:
        message_type, payload = 0xC0, start + struct.pack('<H', len(text)) + text
    frame = make_frame(version, message_type, payload, draw(st.sampled_from(('word', 'byte'))))
    assume(b'NE' not in frame[2:])
    return frame


@st.composite
def flipped_frames(draw: Draw, frames: Frames) -> bytes:
    """Draw a frame with one to three of its bits flipped."""
    frame = bytearray(draw(frames))
    bits = st.integers(0, 8 * len(frame) - 1)
    for bit in draw(st.sets(bits, min_size=1, max_size=3)):
        frame[bit // 8] ^= 1 << bit % 8
    return bytes(frame)


@st.composite
def truncated_frames(draw: Draw) -> bytes:
    """Draw the beginning of a frame."""
    frame = draw(known_frames() | debug_frames())
    return frame[:draw(st.integers(1, len(frame) - 1))]


def noise() -> Frames:
    """Draw bytes that hold no intact frame and do what they can to look like one."""
    headers = [b'NE' + struct.pack('<HB', version, message_type)
               for version in (1, 2, 3, 4, 0x454E) for message_type in
               (0x01, 0x03, 0x1F, 0x45, 0x4E, 0xC0, 0xF0, 0xF3)]
    pieces = st.one_of(
        st.binary(max_size=50),
        st.lists(st.sampled_from((b'N', b'E')), max_size=20).map(b''.join),
        st.sampled_from(headers),
        truncated_frames(),
        flipped_frames(known_frames()),
    )
    return st.lists(pieces, max_size=5).map(b''.join)


def chunks(data: bytes, sizes: Sequence[int]) -> Iterator[bytes]:
    """Cut data into chunks of these sizes, repeated for as long as there is data."""
    position, turn = 0, 0
    while position < len(data):
        size = sizes[turn % len(sizes)]
        yield data[position:position + size]
        position, turn = position + size, turn + 1


def chunk_sizes() -> st.SearchStrategy[list[int]]:
    """Draw sizes for chunks."""
    return st.lists(st.integers(1, 70), min_size=1, max_size=8)
