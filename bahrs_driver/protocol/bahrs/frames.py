# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Frames of the BAHRS: marker, version, type, payload, padding, checksum.

    4E 45 | version u16 | type u8 | payload | padding | CRC u32          (little-endian)

There is no length field: version and type determine it. Stream messages are padded to whole 32-bit
words with one to four bytes, never none (section 2.2, and observed). Their CRC is CRC-32/MPEG-2:
in the document over single bytes, in the device over 32-bit words. Service messages are unpadded
or padded, with the CRC-32/MPEG-2 of the document or the ordinary CRC-32 of the device maker's
tool. All variants are accepted: the CRC of each frame shows which one it is.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
import struct
from typing import Literal

from bahrs_driver.protocol.bahrs import checksum
from bahrs_driver.protocol.bahrs.messages import (
    BahrsMessage, HeightFormat, layouts, MESSAGES, VERSIONS)
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Frame

MARKER = b'NE'
HEADER = struct.Struct('<2sHB')
_HEADER_SIZE = HEADER.size
CRC_SIZE = 4

CrcOrder = Literal['word', 'byte']
Checksum = Literal['word', 'byte', 'crc32']

_PADDINGS = bytes(4), bytes(3), bytes(2), bytes(1)      # by the size before them, modulo 4
_CHECKSUMS = {'word': checksum.mpeg2_words, 'byte': checksum.mpeg2, 'crc32': checksum.crc32}
_Check = tuple[str, Callable[[bytes], bool]]     # name, and whether a whole frame passes
_WORD = 'word', checksum.passes_mpeg2_words
_BYTE = 'byte', checksum.passes_mpeg2
_CRC32 = 'crc32', checksum.passes_crc32


def frame_size(payload_size: int, padded: bool) -> int:
    """Return the size of a whole frame."""
    size = HEADER.size + payload_size
    return size + (len(_PADDINGS[size % 4]) if padded else 0) + CRC_SIZE


def build_frame(version: int, message_type: int, payload: bytes, checksum: Checksum,
                padded: bool = True) -> bytes:
    """Build a frame around any payload. The word checksum requires padding."""
    return _close_frame(HEADER.pack(MARKER, version, message_type) + payload, checksum, padded)


def _close_frame(body: bytes, checksum: Checksum, padded: bool) -> bytes:
    """Append padding and checksum to header and payload."""
    if padded:
        body += _PADDINGS[len(body) % 4]
    return body + _CHECKSUMS[checksum](body)


def frame_version(data: bytes) -> int:
    """Return the protocol version of a frame."""
    version: int = HEADER.unpack_from(data)[1]
    return version


def frame_type(data: bytes) -> int:
    """Return the message type of a frame."""
    message_type: int = HEADER.unpack_from(data)[2]
    return message_type


class BahrsFormat:
    """
    Frame format of the BAHRS.

    `order` is the CRC order of the stream, and frames of the other order are rejected. With 'auto'
    both are accepted, and the latest one, `order_seen`, is tried first.
    """

    marker = MARKER
    header_size = HEADER.size

    def __init__(self, order: Literal['auto', 'word', 'byte'] = 'auto') -> None:
        self.order_seen: str | None = None
        self._latest_frame = b''        # of the stream
        self._checks = [check for check in (_WORD, _BYTE) if order in ('auto', check[0])]
        self._sizes = {
            HEADER.pack(MARKER, version, message_type): tuple(sorted(
                {frame_size(layout.size, padded)
                 for padded in ((False, True) if layout.message.SERVICE else (True,))}))
            for (version, message_type), layout in layouts().items()}
        self._services = {message.TYPE for message in MESSAGES if message.SERVICE}

    @property
    def version_seen(self) -> int | None:
        """Protocol version of the latest frame; None without one."""
        return frame_version(self._latest_frame) if self._latest_frame else None

    @property
    def single_sizes(self) -> Mapping[bytes, int]:
        """Sizes of frames by header, for headers with one size."""
        return {header: sizes[0] for header, sizes in self._sizes.items() if len(sizes) == 1}

    @property
    def first_checksum(self) -> Callable[[bytes], bytes]:
        """Checksum that is tried first."""
        return _CHECKSUMS[self._checks[0][0]]

    def sizes(self, header: bytes,
              _expected: Collection[type] | None = None) -> tuple[int, ...]:
        """Return the sizes of a frame with this header, ascending; none for an unknown type."""
        return self._sizes.get(header, ())

    def passing_checksum(self, frame: bytes,
                         _expected: Collection[type] | None = None) -> str | None:
        """Return the name of the checksum that passes: 'word', 'byte' or 'crc32'."""
        if frame[4] in self._services:
            return _first_passing(frame, (_CRC32, _BYTE, _WORD))
        for order, passes in self._checks:
            if passes(frame):
                self._latest_frame = frame
                if order != self.order_seen:
                    self._prefer(order)
                return order
        return None

    def _prefer(self, order: str) -> None:
        """Try an order first from now on."""
        self.order_seen = order
        self._checks.sort(key=lambda check: check[0] != order)

    def name_unknown(self, frame: bytes) -> str | None:
        """Return type and version of an intact frame of an unknown type, as text."""
        if len(frame) < frame_size(0, padded=False):
            return None
        if not _first_passing(frame, (*self._checks, _CRC32)):
            return None
        _, version, message_type = HEADER.unpack_from(frame)
        return f'0x{message_type:02X}' if version in VERSIONS \
            else f'0x{message_type:02X} of version {version}'


def _first_passing(frame: bytes, checks: Iterable[_Check]) -> str | None:
    for name, passes in checks:
        if passes(frame):
            return name
    return None


class BahrsCodec(Decoder):
    """Decodes and encodes BAHRS frames."""

    def __init__(self, height_format: HeightFormat = 'uint16') -> None:
        """Decode and encode the pressure height in a format."""
        self._with_headers = {key: (HEADER.pack(MARKER, *key), layout)
                              for key, layout in layouts(height_format).items()}
        self.layouts_by_header = dict(self._with_headers.values())
        self._decoders = {header: layout.decode
                          for header, layout in self._with_headers.values()}

    def decode(self, frame: Frame, _now: int = 0) -> BahrsMessage:
        """Return the message of an intact frame."""
        data = frame.data
        return self._decoders[data[:_HEADER_SIZE]](data, _HEADER_SIZE)

    def raw(self, frame: Frame) -> dict[str, object]:
        """Return the raw numbers of an intact frame by field name."""
        return self.layouts_by_header[frame.data[:HEADER.size]].raw(frame.data, HEADER.size)

    def encode(self, message: BahrsMessage, version: int, checksum: Checksum | None = None,
               padded: bool | None = None) -> bytes:
        """
        Encode a message.

        By default stream messages are padded, with a CRC in word order, as the device sends them;
        service messages are unpadded, with a CRC-32, as its maker's tool sends them. Raise
        ValueError if the version has no such message or a value does not fit its field.
        """
        found = self._with_headers.get((version, message.TYPE))
        if found is None:
            raise ValueError(f'{message.NAME} does not exist in protocol version {version}')
        header, layout = found
        return _close_frame(header + layout.encode(message),
                            checksum or ('crc32' if message.SERVICE else 'word'),
                            not message.SERVICE if padded is None else padded)
