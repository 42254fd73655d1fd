"""Commands on their way: each is sent again until the server answers or its time is up.

The server applies a (client, sequence) once however often it arrives, so repeating is safe. Knows no clock and no
network: the caller says what time it is and puts the bytes on the wire. Not thread-safe by itself.

Only WINDOW of them are on the wire at a time, the others wait for their turn: so ten thousand commands given at once
neither flood the server nor leave its memory of numbers before they are answered.
"""

from __future__ import annotations

import enum
import random
from collections import OrderedDict, deque
from concurrent.futures import Future, InvalidStateError
from dataclasses import dataclass
from typing import Deque, List, Tuple

from .errors import NoAnswer, Refused
from .messages import ack_t


_NEVER = float("inf")


class Status(enum.IntEnum):
    """ack_t.status, see protocol/channels.h."""

    APPLIED = 0
    QUEUED = 1
    UNKNOWN_BODY = 2
    STALE_GENERATION = 3
    NOT_FINITE = 4
    OUT_OF_RANGE = 5
    EXPIRED = 6
    WRONG_SESSION = 7
    QUEUE_FULL = 8
    UNKNOWN_VERB = 9
    INVALID = 10
    CANCELLED = 11
    TOO_OLD = 12
    MALFORMED = 13


@dataclass(frozen=True)
class Answer:
    """What the server made of a command."""

    status: int
    """A Status; a number if the server is newer than this client."""
    step: int
    """First step it acts in; -1 if refused."""
    body: int
    """Index of the body, the new one for a spawn; -1 without one."""
    generation: int
    detail: str
    """The server's reason, for people; empty if accepted."""

    @property
    def accepted(self) -> bool:
        return self.status in (Status.APPLIED, Status.QUEUED)

    @property
    def text(self) -> str:
        """One sentence: the server's reason, or else the status in words."""
        known = [status for status in Status if status == self.status]
        name = known[0].name.lower().replace("_", " ") if known else f"status {self.status}"
        return self.detail or name


@dataclass
class _Waiting:
    channel: str
    data: bytes
    since: float
    """When it first went out; until then, when it was given to the outbox."""
    next: float
    """When it goes out next."""
    future: "Future[Answer]"


class Outbox:
    RESEND = 0.05
    """Seconds between repetitions."""
    WINDOW = 256
    """Largest span of numbers on the wire: a quarter of those that a server remembers of a client."""

    def __init__(self, limit: float) -> None:
        self.client = random.SystemRandom().randrange(1, 1 << 63)
        self._limit = limit
        self._sequence = 0
        self._sent: "OrderedDict[int, _Waiting]" = OrderedDict()  # on the wire, by number
        self._queue: Deque[Tuple[int, _Waiting]] = deque()  # wait for their turn
        self._next = _NEVER  # when those on the wire want to be looked at
        self._answered = False  # since take_due
        self._progress = -_NEVER  # when answers were seen last

    def next_sequence(self) -> int:
        """Number for the next command, rising from 1."""
        self._sequence += 1
        return self._sequence

    def add(self, sequence: int, channel: str, data: bytes, now: float) -> "Future[Answer]":
        """Takes over a command, due at once or when its turn comes; the future ends with its Answer, Refused or
        NoAnswer: a time limit after it went out first, or before, if the server has been silent for that long.
        """
        future: "Future[Answer]" = Future()
        self._queue.append((sequence, _Waiting(channel, data, now, now, future)))
        return future

    def take_due(self, now: float) -> List[Tuple[str, bytes]]:
        """(channel, data) to put on the wire now, oldest first. Those whose time is up are given up."""
        if self._answered:
            self._answered, self._progress = False, now
        if now < self._next and not self._has_room():
            return []
        self._give_up(now)
        while self._has_room():
            sequence, command = self._queue.popleft()
            command.since = command.next = now
            self._sent[sequence] = command
        due, self._next = [], _NEVER
        for command in self._sent.values():
            if now >= command.next:
                command.next = now + self.RESEND
                due.append((command.channel, command.data))
            self._next = min(self._next, command.next, command.since + self._limit)
        return due

    def _has_room(self) -> bool:
        """Whether the first of the queue may go out."""
        return bool(self._queue) and (not self._sent or self._queue[0][0] < next(iter(self._sent)) + self.WINDOW)

    def _give_up(self, now: float) -> None:
        """The first of both in their order have the earliest ends."""
        while self._sent and now >= next(iter(self._sent.values())).since + self._limit:
            self._give_up_one(self._sent.popitem(last=False)[1])
        while self._queue and now >= max(self._queue[0][1].since, self._progress) + self._limit:
            self._give_up_one(self._queue.popleft()[1])

    def _give_up_one(self, command: _Waiting) -> None:
        _finish(command.future.set_exception, NoAnswer(f"no answer within {self._limit:g} s; see: tumble doctor"))

    def receive(self, message: ack_t) -> None:
        """Picks out the answers to this client's commands."""
        for i in range(message.n):
            command = self._sent.pop(message.sequence[i], None) if message.client[i] == self.client else None
            if command is None:
                continue
            self._answered = True
            answer = Answer(
                message.status[i], message.applied_step[i], message.body[i], message.generation[i], message.detail[i]
            )
            if answer.accepted:
                _finish(command.future.set_result, answer)
            else:
                _finish(command.future.set_exception, Refused(answer))

    def __len__(self) -> int:
        return len(self._sent) + len(self._queue)


def _finish(set_outcome, outcome) -> None:  # type: ignore[no-untyped-def]
    try:
        set_outcome(outcome)
    except InvalidStateError:  # the caller cancelled it
        pass
