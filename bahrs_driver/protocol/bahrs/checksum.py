# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The three checksums of BAHRS frames.

The device's CRC is CRC-32/MPEG-2 (BAHRS document, section 2.2). It is zlib's CRC-32 with the
bits of each input byte and of the result in reverse order, so zlib computes it.
"""

from array import array
import zlib

SIZE = 4        # bytes
# zlib's CRC of a message followed by its CRC, highest bit first, before the final inversion: 0.
_RESIDUE = 0xFFFFFFFF
_BITS_REVERSED = bytes(int(f'{byte:08b}'[::-1], 2) for byte in range(256))


def crc32(data: bytes) -> bytes:
    """Return the reflected CRC-32 (zlib's) of data as four little-endian bytes."""
    return zlib.crc32(data).to_bytes(4, 'little')


def mpeg2(data: bytes) -> bytes:
    """Return the CRC-32/MPEG-2 of data, byte by byte, as four little-endian bytes."""
    return _to_bytes(zlib.crc32(data.translate(_BITS_REVERSED)))


def mpeg2_words(data: bytes) -> bytes:
    """
    Return the CRC-32/MPEG-2 of data as little-endian 32-bit words.

    The CRC unit of the device's microcontroller computes it when it is fed words. Raise ValueError
    if the length of data is not a multiple of four.
    """
    words = array('I', data.translate(_BITS_REVERSED))
    words.byteswap()
    return _to_bytes(zlib.crc32(words))


def passes_crc32(frame: bytes) -> bool:
    """Return whether the last four bytes of a frame are the reflected CRC-32 of the others."""
    return crc32(frame[:-SIZE]) == frame[-SIZE:]


def passes_mpeg2(frame: bytes) -> bool:
    """Return whether the last four bytes of a frame are the CRC-32/MPEG-2 of the others."""
    return mpeg2(frame[:-SIZE]) == frame[-SIZE:]


def passes_mpeg2_words(frame: bytes) -> bool:
    """Return whether the last word of a frame is the CRC-32/MPEG-2 of the words before it."""
    try:
        words = array('I', frame.translate(_BITS_REVERSED))
    except ValueError:      # the size is not a multiple of four
        return False
    words.byteswap()        # so that the CRC is the highest byte first, as the residue needs it
    return zlib.crc32(words) == _RESIDUE


def _to_bytes(crc: int) -> bytes:
    """Return the four little-endian bytes of a CRC that zlib computed for reversed bits."""
    # To reverse the bits of the word, reverse its bytes and the bits of each byte.
    return (crc ^ 0xFFFFFFFF).to_bytes(4, 'big').translate(_BITS_REVERSED)
