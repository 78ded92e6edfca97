# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Asking a Titan-M, and telling which answer goes with which request. No I/O; time is passed in.

Each kind of request has its turn at its own rate. The device answers one after another, so the
simple way is to wait for an answer, or to give it up, before the next request. Pipelined, one
request of each kind may be outstanding, as long as their answers fit on the line, for adapters
that hold bytes back. GPS and sensor requests are outstanding together only if their answers are
known to differ in length: nothing else tells them apart.

An answer goes with the oldest outstanding request of its kind. If message ids are counted, and
the device is seen to send them back, it must have the id of that request, too. An answer that goes
with no request came late or twice, and is no data: its time is not known. So is one that comes
sooner after its request than the line can carry the two, if another of its kind was given up just
before, and no answer before was as quick: it is the late answer to that one.

How long to wait is learnt: the slowest of the last answers, twice, and a margin. A request that
is not answered is repeated, at once and a few times. When several in a row were not, the other
byte order of the checksum is tried, as the document does not say which the device wants.

All times are in ns, of one clock that nobody sets.
"""

from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.schedule import Schedule
from bahrs_driver.protocol.titan_m.frames import (
    Answer, answer_of, answer_size, AnswerFormat, build_request, CHECKSUM_ORDERS, OrderChoice,
    REQUEST_SIZE,
)
from bahrs_driver.protocol.titan_m.messages import (
    ByteOrder, Gps, REQUESTS, Sensors, TitanAnswer, TitanRequest,
)
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_MS

MARGIN = 20 * NS_PER_MS             # on what answers have taken
LONGEST_BACKLOG = 20 * NS_PER_MS    # of answers that the line has yet to carry
MEASURED = 32                       # answers whose delay is remembered
FEW_MEASURED = 4                    # of them at least are needed to know
UNANSWERED = 3                      # in a row, and another byte order is tried
ID_VOTES, ID_MAJORITY = 8, 6        # of the last answers that had the id of their request
REMEMBERED = 8                      # requests that were given up
FASTEST_LINE = 0.95                 # of the time that a line needs by its nominal rate

Kind = type[TitanRequest]


@dataclass(frozen=True)
class PollOptions:
    """What the user may choose; time in ns."""

    pipelined: bool = False
    timeout: int = 200 * NS_PER_MS      # at most; less, once it is known how long answers take
    retries: int = 1
    counted_ids: bool = False           # rather than always 0, as in the document
    checksum_order: OrderChoice = 'auto'


class Pending(NamedTuple):
    """A request that was sent: its kind and id, when, until when to wait, and how often before."""

    kind: Kind
    message_id: int
    sent: int
    deadline: int
    attempt: int


class Poller:
    """
    Tells what to send, and when, and what an answer answers.

    Counters have kinds as keys: `requests` sent, `answered`, `unanswered` (each attempt), `lost`
    (after the last attempt), and `unexpected` answers.
    """

    def __init__(self, rates: Mapping[Kind, float], frame_format: AnswerFormat,
                 options: PollOptions = PollOptions()) -> None:
        """Take rates in Hz, and the format that answers are found with."""
        self.requests: Counter[Kind] = Counter()
        self.answered: Counter[Kind] = Counter()
        self.unanswered: Counter[Kind] = Counter()
        self.lost: Counter[Kind] = Counter()
        self.unexpected: Counter[Kind] = Counter()
        self.checksum_order: ByteOrder = (
            CHECKSUM_ORDERS[0] if options.checksum_order == 'auto' else options.checksum_order)
        self._options = options
        self._format = frame_format
        self._schedule = Schedule(rates)
        self._next_id = 0
        self.begin(0, 0)
        self.end()

    def begin(self, now: int, byte_time: int) -> None:
        """Take note that the line is open, and of how long a byte takes on it."""
        self._format.begin()
        self._byte_time = byte_time
        self._active = True
        self._schedule.begin(now)
        self._outstanding: list[Pending] = []
        self._given_up: deque[Pending] = deque(maxlen=REMEMBERED)
        self._again: deque[tuple[Kind, int]] = deque()
        self._delays: deque[int] = deque(maxlen=MEASURED)
        self._paced: deque[bool] = deque(maxlen=MEASURED)   # that the line is as slow as its rate
        self._ids: deque[bool] = deque(maxlen=ID_VOTES)
        self._in_a_row = 0          # requests without an answer
        self._line_free = now       # when the line has carried the answers asked for

    def end(self) -> None:
        """Take note that the line is gone, and ask nothing."""
        self._active = False
        self._outstanding.clear()

    @property
    def skipped(self) -> int:
        """How many turns were left out because the line or the device was too slow."""
        return self._schedule.skipped

    @property
    def lost_by_name(self) -> dict[str, int]:
        """Return how many of each answer never came, by its name."""
        # Another thread may ask while a kind is lost for the first time: do not go through lost.
        return {kind.ANSWER.NAME: self.lost[kind] for kind in REQUESTS}

    @property
    def slowest(self) -> int | None:
        """Return what the slowest answer of late took beyond its time on the line, if known."""
        return max(self._delays) if len(self._delays) >= FEW_MEASURED else None

    @property
    def returns_ids(self) -> bool:
        """Whether the device is seen to send back the ids of requests."""
        return self._options.counted_ids and sum(self._ids) >= ID_MAJORITY

    def expected(self) -> list[type[TitanAnswer]]:
        """Return what is waited for."""
        return [pending.kind.ANSWER for pending in self._outstanding]

    def due(self, now: int) -> int | None:
        """Return when to call send(); None is when an answer has come, or never."""
        if not self._active:
            return None
        if self._choose(now):
            return now
        times = [pending.deadline for pending in self._outstanding]
        if self._options.pipelined or not self._outstanding:
            room = self._line_free - LONGEST_BACKLOG
            turn = self._schedule.next_after(now)
            times += [time for time in (room, turn) if time is not None and time > now]
        return min(times, default=None)

    def send(self, now: int) -> bytes:
        """Give up what has waited too long, and return the next request; empty if it must wait."""
        if not self._active:
            return b''
        self._give_up(now)
        kind = self._choose(now)
        if not kind:
            return b''
        if self._again and self._again[0][0] is kind:
            _, attempt = self._again.popleft()
        else:
            attempt = 0
            self._schedule.take(kind, now)
        return self._ask(kind, now, attempt)

    def receive(self, frame: Frame, now: int) -> Answer:
        """Take an answer that has come; return it with when it was asked for, if it was."""
        answer = answer_of(frame)
        waiting = [pending for pending in self._outstanding if pending.kind.ANSWER is answer.kind]
        had_id = [pending for pending in waiting if pending.message_id == answer.message_id]
        found = had_id if self.returns_ids else waiting
        if waiting:
            self._ids.append(bool(had_id))
        if not found or self._is_late(found[0], now):
            self._note_unexpected(answer.kind, now)
            return replace(answer, wanted=False)
        pending = found[0]
        self._outstanding.remove(pending)
        self.answered[pending.kind] += 1
        self._in_a_row = 0
        self._paced.append(self._is_paced(pending, now))
        self._measure(pending, now)
        return replace(answer, asked=pending.sent)

    def _choose(self, now: int) -> Kind | None:
        """Return what to ask for now."""
        if self._outstanding and not self._options.pipelined:
            return None
        if self._outstanding and self._line_free > now + LONGEST_BACKLOG:
            return None
        wanted = [kind for kind, _ in list(self._again)[:1]] + self._schedule.due(now)
        return next((kind for kind in wanted if self._may_ask(kind)), None)

    def _may_ask(self, kind: Kind) -> bool:
        expected = self.expected()
        if kind.ANSWER in expected:
            return False
        other = {Gps: Sensors, Sensors: Gps}.get(kind.ANSWER)
        return other not in expected or self._format.tells_apart

    def _ask(self, kind: Kind, now: int, attempt: int) -> bytes:
        message_id = self._next_id
        if self._options.counted_ids:
            self._next_id = (message_id + 1) % COUNTER_MODULUS
        arrives = now + REQUEST_SIZE * self._byte_time
        self._line_free = max(self._line_free, arrives) \
            + answer_size(kind.ANSWER) * self._byte_time
        self._outstanding.append(Pending(
            kind, message_id, now, self._line_free + self._patience(), attempt))
        self.requests[kind] += 1
        return build_request(kind, message_id, self.checksum_order)

    def _patience(self) -> int:
        slowest = self.slowest
        longest = self._options.timeout
        return longest if slowest is None else min(longest, MARGIN + 2 * slowest)

    def _give_up(self, now: int) -> None:
        for pending in [item for item in self._outstanding if item.deadline <= now]:
            self._outstanding.remove(pending)
            self._given_up.append(pending)
            self.unanswered[pending.kind] += 1
            if pending.attempt < self._options.retries:
                self._again.append((pending.kind, pending.attempt + 1))
            else:
                self.lost[pending.kind] += 1
            self._note_silence()
        if not self._outstanding:
            self._line_free = min(self._line_free, now)

    def _note_silence(self) -> None:
        self._in_a_row += 1
        if self._in_a_row % UNANSWERED == 0:
            self._delays.clear()        # what was learnt does not hold any more
            if self._options.checksum_order == 'auto':
                self.checksum_order = 'little' if self.checksum_order == 'big' else 'big'

    def _is_late(self, pending: Pending, now: int) -> bool:
        """Whether an answer that has come now is to an earlier request than this."""
        if self._abandoned(pending.kind, now) is None or self.returns_ids:
            return False
        sure = len(self._paced) >= FEW_MEASURED and all(self._paced)
        return sure and not self._is_paced(pending, now)

    def _is_paced(self, pending: Pending, now: int) -> bool:
        """Whether an answer that has come now took at least what the line needs for it."""
        return now - pending.sent >= FASTEST_LINE * self._line_time(pending.kind)

    def _abandoned(self, kind: Kind, now: int) -> Pending | None:
        """Return the latest request of a kind that was given up not long ago."""
        return next((pending for pending in reversed(self._given_up) if pending.kind is kind
                     and now - pending.deadline < self._options.timeout), None)

    def _note_unexpected(self, answer: type[TitanAnswer], now: int) -> None:
        kind, = (kind for kind in REQUESTS if kind.ANSWER is answer)
        self.unexpected[kind] += 1
        pending = self._abandoned(kind, now)
        if pending:                     # it was only late: wait longer
            self._given_up.remove(pending)
            self._measure(pending, now)

    def _measure(self, pending: Pending, now: int) -> None:
        self._delays.append(max(0, now - pending.sent - self._line_time(pending.kind)))

    def _line_time(self, kind: Kind) -> int:
        """Return what the line needs for a request and its answer."""
        return (REQUEST_SIZE + answer_size(kind.ANSWER)) * self._byte_time
