# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Frames of the Titan-M: address, command, LEN, message id, payload, checksum.

    33 "GST" | 02  | id |               | sum      host to device
    31 "ACK" | LEN | id | 44, 48, 56 B  | sum      device to host

LEN counts payload and checksum. The checksum is the sum of all bytes before it, modulo 65,536.
The document does not state its byte order: both are accepted until a few frames show which one
the device uses.

The checksum is weak, and two kinds of answers have LEN 0x2E. The outstanding requests decide
between them: an expected answer is preferred to one that is not. If the requests are not known,
as in a recording, such a frame is a GPS answer only if its UTM zone is valid.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.titan_m.messages import (
    ANSWERS, ByteOrder, Gps, LAST_ZONE, LAYOUTS, PAYLOAD_SIZES, REQUESTS, Sensors, TitanAnswer,
    TitanRequest,
)

ANSWER_MARKER = b'\x31ACK'
REQUEST_ADDRESS = b'\x33'
REQUEST_MARKER = b'\x33G'
HEADER_SIZE = 6
CHECKSUM_SIZE = 2
REQUEST_SIZE = HEADER_SIZE + CHECKSUM_SIZE
ENOUGH = 5              # consecutive frames of one checksum order, after which it is locked

OrderChoice = Literal['auto', 'little', 'big']
CHECKSUM_ORDERS: tuple[ByteOrder, ...] = ('big', 'little')     # that of the document first

_LENGTH, _MESSAGE_ID = 4, 5
_ZONE, _HEMISPHERE = HEADER_SIZE + 40, HEADER_SIZE + 41


def checksum(body: bytes, order: ByteOrder) -> bytes:
    """Return the sum of the bytes of a frame, modulo 65,536, encoded in a byte order."""
    return (sum(body) & 0xFFFF).to_bytes(CHECKSUM_SIZE, order)


def answer_size(kind: type[TitanAnswer]) -> int:
    """Return the size of a whole answer."""
    return HEADER_SIZE + PAYLOAD_SIZES[kind] + CHECKSUM_SIZE


KIND_BY_SIZE = {answer_size(kind): kind for kind in ANSWERS}
KINDS_BY_LENGTH = {length: sorted((kind for kind in ANSWERS if length in kind.LENGTHS),
                                  key=answer_size)
                   for kind in ANSWERS for length in kind.LENGTHS}
_REQUESTS_BY_COMMAND = {kind.COMMAND: kind for kind in REQUESTS}


def build_request(kind: type[TitanRequest], message_id: int = 0,
                  checksum_order: ByteOrder = 'big') -> bytes:
    """Encode a request; the defaults give the bytes printed in the document."""
    body = REQUEST_ADDRESS + kind.COMMAND + bytes([CHECKSUM_SIZE, message_id])
    return body + checksum(body, checksum_order)


def build_answer(message: TitanAnswer, message_id: int = 0, payload_order: ByteOrder = 'little',
                 checksum_order: ByteOrder = 'big', length: int | None = None) -> bytes:
    """
    Encode an answer. LEN is that of its kind unless it is given.

    Raise ValueError if a value does not fit its field.
    """
    payload = LAYOUTS[type(message), payload_order].encode(message)
    length = message.LENGTHS[0] if length is None else length
    body = ANSWER_MARKER + bytes([length, message_id]) + payload
    return body + checksum(body, checksum_order)


@dataclass(frozen=True, slots=True)
class Answer(Message):
    """
    An answer whose payload is not decoded yet.

    `requested_at` is the time of its request, in ns of the host's raw clock; None if not known.
    `expected` is False for an answer to no outstanding request: it arrived late or twice.
    """

    kind: type[TitanAnswer]
    message_id: int
    payload: bytes
    requested_at: int | None = None
    expected: bool = True

    @property
    def NAME(self) -> str:  # type: ignore[override]  # noqa: N802
        """Name of the message; 'unexpected' if it answers no outstanding request."""
        return self.kind.NAME if self.expected else 'unexpected'


def answer_of(frame: Frame) -> Answer:
    """Return the answer in an intact frame."""
    data = frame.data
    return Answer(KIND_BY_SIZE[len(data)], data[_MESSAGE_ID], data[HEADER_SIZE:-CHECKSUM_SIZE])


def message_id(frame: Frame) -> int:
    """Return the message id of an intact frame."""
    return frame.data[_MESSAGE_ID]


def request_of(frame: Frame) -> type[TitanRequest]:
    """Return the kind of the request in an intact frame."""
    return _REQUESTS_BY_COMMAND[frame.data[1:4]]


class ChecksumOrder:
    """
    Detects the byte order of checksums.

    `seen` is the order of the latest frame that shows one; a checksum of two equal bytes does not.
    Once an order is locked, frames of the other order are rejected, until so many of them arrive
    in a row that another device must be on the line.
    """

    def __init__(self, order: OrderChoice = 'auto') -> None:
        self._forced = order
        self.reset()

    def reset(self) -> None:
        """Forget the order: another device may be on the line."""
        self.seen: ByteOrder | None = None if self._forced == 'auto' else self._forced
        self._consecutive = ENOUGH if self.seen else 0
        self._rejected = 0

    @property
    def locked(self) -> bool:
        """Whether frames of the other order are rejected."""
        return self._consecutive >= ENOUGH

    def passing(self, frame: bytes) -> ByteOrder | None:
        """Return the order in which the checksum of a frame is correct and accepted."""
        body, found = frame[:-CHECKSUM_SIZE], frame[-CHECKSUM_SIZE:]
        if self.seen and checksum(body, self.seen) == found:
            self._rejected = 0
            return self.seen
        order = next((order for order in CHECKSUM_ORDERS if checksum(body, order) == found), None)
        return None if order and self._rejects() else order

    def record(self, frame: bytes, order: ByteOrder) -> None:
        """Record the order of an intact frame."""
        if frame[-2] != frame[-1] and not self.locked:
            self._consecutive = self._consecutive + 1 if order == self.seen else 1
            self.seen = order

    def _rejects(self) -> bool:
        """Count a frame of the other order; return whether it is rejected."""
        if self.locked and self._forced == 'auto':
            self._rejected += 1
            if self._rejected >= ENOUGH:
                self.reset()
        return self.locked


class AnswerFormat:
    """Frame format of answers. `lengths_seen` has the latest LEN of each kind."""

    marker = ANSWER_MARKER
    header_size = HEADER_SIZE

    def __init__(self, checksum_order: OrderChoice = 'auto') -> None:
        self.checksum_order = ChecksumOrder(checksum_order)
        self.reset()

    def reset(self) -> None:
        """Forget what was detected: another device may be on the line."""
        self.checksum_order.reset()
        self.lengths_seen: dict[type[TitanAnswer], int] = {}

    @property
    def lengths_differ(self) -> bool:
        """Whether GPS and sensor answers are known to differ in LEN."""
        return self.lengths_seen.get(Sensors) == Sensors.LENGTHS[0]

    def sizes(self, header: bytes, expected: Collection[type] | None) -> tuple[int, ...]:
        """Return the possible sizes of an answer with this header."""
        length = header[_LENGTH] if len(header) == HEADER_SIZE else 0
        kinds = KINDS_BY_LENGTH.get(length, [])
        if len(kinds) > 1 and expected is not None and not self.lengths_differ:
            kinds = [kind for kind in kinds if kind in expected] or kinds
        return tuple(answer_size(kind) for kind in kinds)

    def passing_checksum(self, frame: bytes, expected: Collection[type] | None) -> str | None:
        """Return the byte order in which the checksum of a frame is correct."""
        order = self.checksum_order.passing(frame)
        if not order or (expected is None and not self._is_plausible(frame)):
            return None
        self.checksum_order.record(frame, order)
        self.lengths_seen[KIND_BY_SIZE[len(frame)]] = frame[_LENGTH]
        return order

    def name_unknown(self, _frame: bytes) -> str | None:
        """Return None: answers of other lengths are not known to exist."""
        return None

    def _is_plausible(self, frame: bytes) -> bool:
        """Return whether a frame is more than the first part of a longer one."""
        if self.lengths_differ or KIND_BY_SIZE[len(frame)] is not Gps:
            return True
        return frame[_ZONE] <= LAST_ZONE and frame[_HEMISPHERE] <= 1


class RequestFormat:
    """Frame format of requests."""

    marker = REQUEST_MARKER
    header_size = HEADER_SIZE

    def __init__(self, checksum_order: OrderChoice = 'auto') -> None:
        self._order = ChecksumOrder(checksum_order)

    def sizes(self, header: bytes, _expected: Collection[type] | None) -> tuple[int, ...]:
        """Return the size of a request if the header is that of one."""
        known = header[1:4] in _REQUESTS_BY_COMMAND and header[_LENGTH] == CHECKSUM_SIZE
        return (REQUEST_SIZE,) if len(header) == HEADER_SIZE and known else ()

    def passing_checksum(self, frame: bytes, _expected: Collection[type] | None) -> str | None:
        """Return the byte order in which the checksum of a frame is correct."""
        return self._order.passing(frame)

    def name_unknown(self, _frame: bytes) -> str | None:
        """Return None: other commands are not known to exist."""
        return None
