# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Polling of a Titan-M: which request is due, and which request an answer belongs to.

Each kind of request is due at its own rate. The device answers one request after another, so the
simple mode waits for an answer, or for its time-out, before the next request. In pipelined mode
one request of each kind may be outstanding, as long as their answers fit on the line, for adapters
that hold bytes back. GPS and sensor requests are outstanding together only if their answers are
known to differ in length: nothing else distinguishes them.

An answer belongs to the oldest outstanding request of its kind. If message ids are counted, and
the device returns them, it must also have the id of that request. An answer to no outstanding
request arrived late or twice: it is unexpected, and is not used as data, because the time of its
measurement is unknown. An answer may also arrive sooner than the line can carry both it and its
request. If no earlier answer did, and a request of its kind timed out shortly before, it is the
late answer to that request, and unexpected.

The time-out is adaptive: twice the delay of the slowest of the latest answers, plus a margin. An
unanswered request is repeated at once, a few times. After several unanswered requests in a row the
other byte order of the checksum is tried, because the document does not state which one the device
expects.

Times are in ns of one steady clock.
"""

from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from bahrs_driver.protocol.schedule import Schedule
from bahrs_driver.protocol.titan_m.frames import (
    Answer, answer_size, AnswerFormat, build_request, CHECKSUM_ORDERS, OrderChoice, REQUEST_SIZE,
)
from bahrs_driver.protocol.titan_m.messages import (
    ByteOrder, Gps, REQUESTS, Sensors, TitanAnswer, TitanRequest,
)
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_MS

MARGIN = 20 * NS_PER_MS           # added to the adaptive time-out
LONGEST_BACKLOG = 20 * NS_PER_MS  # of outstanding answers on the line
MEASURED = 32                       # answers whose delay is remembered
FEW_MEASURED = 4                    # delays needed for an adaptive time-out
UNANSWERED = 3                      # in a row, after which the other checksum order is tried
ID_VOTES, ID_MAJORITY = 8, 6        # of the latest answers with the id of their request
REMEMBERED = 8                      # requests that timed out
FASTEST_LINE = 0.95                 # of the nominal time on the line

Kind = type[TitanRequest]


@dataclass(frozen=True)
class PollOptions:
    """Options of polling; time in ns."""

    pipelined: bool = False
    timeout: int = 200 * NS_PER_MS    # upper bound of the adaptive time-out
    retries: int = 1
    counted_ids: bool = False           # instead of 0, as in the document
    checksum_order: OrderChoice = 'auto'


class Pending(NamedTuple):
    """An outstanding request."""

    kind: Kind
    message_id: int
    sent: int
    deadline: int
    attempt: int            # 0 for the first


class Poller:
    """
    Schedules requests, and matches answers to them.

    Counters have kinds as keys: `requests` sent, `answered`, `unanswered` (each attempt), `lost`
    (after the last attempt), and `unexpected` answers. `write_error` is the reason why the latest
    request was not written; empty if it was.
    """

    def __init__(self, rates: Mapping[Kind, float], frame_format: AnswerFormat,
                 options: PollOptions = PollOptions()) -> None:
        """Poll at rates in Hz; frame_format is that of the framer."""
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
        self.start(0)
        self.stop()

    def start(self, byte_time_ns: int) -> None:
        """Begin to poll on a line that carries a byte in byte_time_ns."""
        self._format.reset()
        self._byte_time = byte_time_ns
        self._active, self._started = True, False
        self._outstanding: list[Pending] = []
        self._timed_out: deque[Pending] = deque(maxlen=REMEMBERED)
        self._repeats: deque[tuple[Kind, int]] = deque()
        self._delays: deque[int] = deque(maxlen=MEASURED)
        self._paced: deque[bool] = deque(maxlen=MEASURED)   # line as slow as its nominal rate
        self._ids: deque[bool] = deque(maxlen=ID_VOTES)
        self._unanswered_in_a_row = 0
        self._line_free = 0         # when the line has carried all outstanding answers
        self.write_error = ''

    def stop(self) -> None:
        """Stop polling: the line is closed."""
        self._active = False
        self._outstanding.clear()
        self.write_error = ''

    @property
    def skipped(self) -> int:
        """Count of turns that were skipped because the line or the device was too slow."""
        return self._schedule.skipped

    @property
    def lost_by_name(self) -> dict[str, int]:
        """Count of lost answers by name."""
        # Do not iterate over lost: another thread may add a kind meanwhile.
        return {kind.ANSWER.NAME: self.lost[kind] for kind in REQUESTS}

    @property
    def slowest(self) -> int | None:
        """Delay of the slowest of the latest answers beyond their time on the line, if known."""
        return max(self._delays) if len(self._delays) >= FEW_MEASURED else None

    @property
    def returns_ids(self) -> bool:
        """Whether the device returns the ids of requests."""
        return self._options.counted_ids and sum(self._ids) >= ID_MAJORITY

    def expected(self) -> list[type[TitanAnswer]]:
        """Return the kinds of outstanding answers."""
        return [pending.kind.ANSWER for pending in self._outstanding]

    def due(self, now: int) -> int | None:
        """Return when to call send(); None if only an answer can make a request due."""
        if not self._active:
            return None
        if self._choose(now):
            return now
        times = [pending.deadline for pending in self._outstanding]
        if self._options.pipelined or not self._outstanding:
            backlog_end = self._line_free - LONGEST_BACKLOG
            next_turn = self._schedule.next_after(now)
            times += [time for time in (backlog_end, next_turn) if time is not None and time > now]
        return min(times, default=None)

    def send(self, now: int) -> bytes:
        """Time out requests, and return the bytes of the next one; empty if none is due."""
        if not self._active:
            return b''
        self._time_out(now)
        kind = self._choose(now)
        if not kind:
            return b''
        attempt = 0
        if self._repeats and self._repeats[0][0] is kind:
            _, attempt = self._repeats.popleft()
        else:
            self._schedule.advance(kind, now)
        return self._request(kind, now, attempt)

    def record_write(self, error: str, _now: int) -> None:
        """Record why the latest request was not written; empty if it was."""
        self.write_error = error if self._active else ''

    def match(self, answer: Answer, now: int) -> Answer:
        """Return an answer with the time of its request, or marked as unexpected."""
        waiting = [pending for pending in self._outstanding if pending.kind.ANSWER is answer.kind]
        same_id = [pending for pending in waiting if pending.message_id == answer.message_id]
        candidates = same_id if self.returns_ids else waiting
        if waiting:
            self._ids.append(bool(same_id))
        if not candidates or self._is_late(candidates[0], now):
            self._record_unexpected(answer.kind, now)
            return replace(answer, expected=False)
        pending = candidates[0]
        self._outstanding.remove(pending)
        self.answered[pending.kind] += 1
        self._unanswered_in_a_row = 0
        self._paced.append(self._is_paced(pending, now))
        self._measure(pending, now)
        return replace(answer, requested_at=pending.sent)

    def _choose(self, now: int) -> Kind | None:
        """Return the kind to request now."""
        if not self._started:       # start() has no time to schedule by
            self._schedule.start(now)
            self._started = True
        if self._outstanding and not self._options.pipelined:
            return None
        if self._outstanding and self._line_free > now + LONGEST_BACKLOG:
            return None
        due = [kind for kind, _ in list(self._repeats)[:1]] + self._schedule.due(now)
        return next((kind for kind in due if self._may_request(kind)), None)

    def _may_request(self, kind: Kind) -> bool:
        expected = self.expected()
        if kind.ANSWER in expected:
            return False
        other = {Gps: Sensors, Sensors: Gps}.get(kind.ANSWER)
        return other not in expected or self._format.lengths_differ

    def _request(self, kind: Kind, now: int, attempt: int) -> bytes:
        message_id = self._next_id
        if self._options.counted_ids:
            self._next_id = (message_id + 1) % COUNTER_MODULUS
        arrives = now + REQUEST_SIZE * self._byte_time
        self._line_free = max(self._line_free, arrives) \
            + answer_size(kind.ANSWER) * self._byte_time
        self._outstanding.append(Pending(
            kind, message_id, now, self._line_free + self._timeout(), attempt))
        self.requests[kind] += 1
        return build_request(kind, message_id, self.checksum_order)

    def _timeout(self) -> int:
        slowest = self.slowest
        longest = self._options.timeout
        return longest if slowest is None else min(longest, MARGIN + 2 * slowest)

    def _time_out(self, now: int) -> None:
        for pending in [item for item in self._outstanding if item.deadline <= now]:
            self._outstanding.remove(pending)
            self._timed_out.append(pending)
            self.unanswered[pending.kind] += 1
            if pending.attempt < self._options.retries:
                self._repeats.append((pending.kind, pending.attempt + 1))
            else:
                self.lost[pending.kind] += 1
            self._record_unanswered()
        if not self._outstanding:
            self._line_free = min(self._line_free, now)

    def _record_unanswered(self) -> None:
        self._unanswered_in_a_row += 1
        if self._unanswered_in_a_row % UNANSWERED == 0:
            self._delays.clear()        # the device or the line may have changed
            if self._options.checksum_order == 'auto':
                self.checksum_order = 'little' if self.checksum_order == 'big' else 'big'

    def _is_late(self, pending: Pending, now: int) -> bool:
        """Return whether an answer received now belongs to an earlier request."""
        if self._recently_timed_out(pending.kind, now) is None or self.returns_ids:
            return False
        line_is_paced = len(self._paced) >= FEW_MEASURED and all(self._paced)
        return line_is_paced and not self._is_paced(pending, now)

    def _is_paced(self, pending: Pending, now: int) -> bool:
        """Return whether an answer received now took at least its time on the line."""
        return now - pending.sent >= FASTEST_LINE * self._line_time(pending.kind)

    def _recently_timed_out(self, kind: Kind, now: int) -> Pending | None:
        """Return the latest request of a kind that timed out recently."""
        return next((pending for pending in reversed(self._timed_out) if pending.kind is kind
                     and now - pending.deadline < self._options.timeout), None)

    def _record_unexpected(self, answer: type[TitanAnswer], now: int) -> None:
        kind, = (kind for kind in REQUESTS if kind.ANSWER is answer)
        self.unexpected[kind] += 1
        pending = self._recently_timed_out(kind, now)
        if pending:                     # its answer was late: raise the time-out
            self._timed_out.remove(pending)
            self._measure(pending, now)

    def _measure(self, pending: Pending, now: int) -> None:
        self._delays.append(max(0, now - pending.sent - self._line_time(pending.kind)))

    def _line_time(self, kind: Kind) -> int:
        """Return the time that a request and its answer take on the line."""
        return (REQUEST_SIZE + answer_size(kind.ANSWER)) * self._byte_time
