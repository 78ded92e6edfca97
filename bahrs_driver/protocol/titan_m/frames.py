# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The frames of the Titan-M: address, command, LEN, message id, payload, checksum.

    33 "GST" | 02  | id |               | sum      host to device
    31 "ACK" | LEN | id | 44, 48, 56 B  | sum      device to host

LEN counts payload and checksum. The checksum is the sum of all bytes before it, modulo 65,536,
in a byte order that the document does not state: either is taken, until a few frames have told.

The checksum is weak, and LEN 0x2E is that of two answers. So what was asked for narrows what is
taken for a frame: an answer that nobody waits for is never one that somebody does. Where nothing
is known of requests, as in a recording, such a frame is a GPS answer only if its zone can be.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import ClassVar, Literal

from bahrs_driver.protocol.framing import Frame
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
ENOUGH = 5              # frames in a row of one checksum order, after which the other is refused

OrderChoice = Literal['auto', 'little', 'big']
CHECKSUM_ORDERS: tuple[ByteOrder, ...] = ('big', 'little')     # as printed first

_LENGTH, _MESSAGE_ID = 4, 5
_ZONE, _HEMISPHERE = HEADER_SIZE + 40, HEADER_SIZE + 41


def checksum(body: bytes, order: ByteOrder) -> bytes:
    """Return the sum of the bytes of a frame, modulo 65,536, in a byte order."""
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
    """Return the frame of a request; by default byte for byte as the document has it."""
    body = REQUEST_ADDRESS + kind.COMMAND + bytes([CHECKSUM_SIZE, message_id])
    return body + checksum(body, checksum_order)


def build_answer(message: TitanAnswer, message_id: int = 0, payload_order: ByteOrder = 'little',
                 checksum_order: ByteOrder = 'big', length: int | None = None) -> bytes:
    """
    Return the frame of an answer. LEN is what its payload makes it unless it is given.

    ValueError where a value does not fit its field.
    """
    payload = LAYOUTS[type(message), payload_order].encode(message)
    length = message.LENGTHS[0] if length is None else length
    body = ANSWER_MARKER + bytes([length, message_id]) + payload
    return body + checksum(body, checksum_order)


@dataclass(frozen=True, slots=True)
class Answer:
    """
    An answer as it came, before it is known in which byte order to read it.

    `asked` is when it was asked for, in ns of the host's raw clock; None if that is not known.
    `wanted` is whether somebody waits for it.
    """

    SERVICE: ClassVar[bool] = False

    kind: type[TitanAnswer]
    message_id: int
    payload: bytes
    asked: int | None = None
    wanted: bool = True

    @property
    def NAME(self) -> str:      # noqa: N802, as all messages have it
        """Name of the message; another one for what nobody waits for."""
        return self.kind.NAME if self.wanted else 'unexpected'


def answer_of(frame: Frame) -> Answer:
    """Return which answer an intact frame is, and what it holds."""
    data = frame.data
    return Answer(KIND_BY_SIZE[len(data)], data[_MESSAGE_ID], data[HEADER_SIZE:-CHECKSUM_SIZE])


class AnswerCodec:
    """Takes answers as they come, for recordings, and where somebody else asks."""

    def expected(self) -> Collection[type[TitanAnswer]]:
        """Return an empty collection: requests are not known."""
        return ()

    def decode(self, frame: Frame, _now: int = 0) -> Answer:
        """Return which answer an intact frame is, and what it holds."""
        return answer_of(frame)


def message_id(frame: Frame) -> int:
    """Return the message id of an intact frame."""
    return frame.data[_MESSAGE_ID]


def request_of(frame: Frame) -> type[TitanRequest]:
    """Return which request an intact frame is."""
    return _REQUESTS_BY_COMMAND[frame.data[1:4]]


class ChecksumOrder:
    """
    Tells the byte order of checksums.

    A sum whose two bytes are equal tells nothing. `seen` is that of the last frame that told.
    Where one order is known, frames of the other are refused, until so many come with none of the
    known one between them that it must be another device.
    """

    def __init__(self, order: OrderChoice = 'auto') -> None:
        self._forced = order
        self.begin()

    def begin(self) -> None:
        """Forget what was seen: another device may be on the line."""
        self.seen: ByteOrder | None = None if self._forced == 'auto' else self._forced
        self._run = ENOUGH if self.seen else 0
        self._refused = 0

    @property
    def known(self) -> bool:
        """Whether only one order is taken."""
        return self._run >= ENOUGH

    def passing(self, frame: bytes) -> ByteOrder | None:
        """Return the order in which the checksum of a frame is right."""
        body, found = frame[:-CHECKSUM_SIZE], frame[-CHECKSUM_SIZE:]
        if self.seen and checksum(body, self.seen) == found:
            self._refused = 0
            return self.seen
        order = next((order for order in CHECKSUM_ORDERS if checksum(body, order) == found), None)
        return None if order and self._refuses() else order

    def note(self, frame: bytes, order: ByteOrder) -> None:
        """Take the order of an intact frame."""
        if frame[-2] != frame[-1] and not self.known:
            self._run = self._run + 1 if order == self.seen else 1
            self.seen = order

    def _refuses(self) -> bool:
        """Whether a frame of the order that was not seen last is refused."""
        if not self.known:
            return False
        if self._forced == 'auto':
            self._refused += 1
            if self._refused >= ENOUGH:
                self.begin()
        return self.known


class AnswerFormat:
    """
    What the framer must know of answers.

    `lengths_seen` has the LEN of each kind, to show. `expected` tells what is waited for; None
    is not known, as in a recording.
    """

    marker = ANSWER_MARKER
    header_size = HEADER_SIZE

    def __init__(self, checksum_order: OrderChoice = 'auto') -> None:
        self.checksum_order = ChecksumOrder(checksum_order)
        self.expected: Callable[[], Collection[type[TitanAnswer]]] | None = None
        self.begin()

    def begin(self) -> None:
        """Forget what was seen: another device may be on the line."""
        self.checksum_order.begin()
        self.lengths_seen: dict[type[TitanAnswer], int] = {}

    @property
    def tells_apart(self) -> bool:
        """Whether GPS and sensor answers are known to differ in LEN."""
        return self.lengths_seen.get(Sensors) == Sensors.LENGTHS[0]

    def sizes(self, header: bytes) -> tuple[int, ...]:
        """Return the sizes that an answer with this header may have."""
        length = header[_LENGTH] if len(header) == HEADER_SIZE else 0
        kinds = KINDS_BY_LENGTH.get(length, [])
        if len(kinds) > 1 and self.expected is not None and not self.tells_apart:
            kinds = [kind for kind in kinds if kind in self.expected()] or kinds
        return tuple(answer_size(kind) for kind in kinds)

    def passing_checksum(self, frame: bytes) -> str | None:
        """Return the byte order of the checksum that vouches for these bytes."""
        order = self.checksum_order.passing(frame)
        if not order or not self._can_be(frame):
            return None
        self.checksum_order.note(frame, order)
        self.lengths_seen[KIND_BY_SIZE[len(frame)]] = frame[_LENGTH]
        return order

    def name_unknown(self, frame: bytes) -> str | None:
        """Return None: answers of other lengths are not known to exist."""
        return None

    def _can_be(self, frame: bytes) -> bool:
        """Whether a frame is not rather the beginning of a longer one."""
        if self.expected is not None or self.tells_apart or KIND_BY_SIZE[len(frame)] is not Gps:
            return True
        return frame[_ZONE] <= LAST_ZONE and frame[_HEMISPHERE] <= 1


class RequestFormat:
    """What the framer must know of requests."""

    marker = REQUEST_MARKER
    header_size = HEADER_SIZE

    def __init__(self, checksum_order: OrderChoice = 'auto') -> None:
        self._order = ChecksumOrder(checksum_order)

    def sizes(self, header: bytes) -> tuple[int, ...]:
        """Return the size of a request, if the header is that of one."""
        known = header[1:4] in _REQUESTS_BY_COMMAND and header[_LENGTH] == CHECKSUM_SIZE
        return (REQUEST_SIZE,) if len(header) == HEADER_SIZE and known else ()

    def passing_checksum(self, frame: bytes) -> str | None:
        """Return the byte order of the checksum that vouches for these bytes."""
        return self._order.passing(frame)

    def name_unknown(self, frame: bytes) -> str | None:
        """Return None: other commands are not known to exist."""
        return None
