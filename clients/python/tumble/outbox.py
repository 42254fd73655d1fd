"""Commands on their way: each is sent again until the server answers or its time is up.

The server applies a (client, sequence) once however often it arrives, so repeating is safe. Knows no clock and no
network: the caller says what time it is and puts the bytes on the wire. Not thread-safe by itself.
"""

from __future__ import annotations

import enum
import random
from concurrent.futures import Future, InvalidStateError
from dataclasses import dataclass
from typing import Dict, List, Tuple

from .errors import NoAnswer, Refused
from .messages import ack_t


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
        known = [status for status in Status if status == self.status]
        name = known[0].name.lower().replace("_", " ") if known else f"status {self.status}"
        return f"{name}: {self.detail}" if self.detail else name


@dataclass
class _Waiting:
    channel: str
    data: bytes
    next: float
    deadline: float
    future: "Future[Answer]"


class Outbox:
    RESEND = 0.05
    """Seconds between repetitions."""

    def __init__(self, limit: float) -> None:
        self.client = random.SystemRandom().randrange(1, 1 << 63)
        self._limit = limit
        self._sequence = 0
        self._waiting: Dict[int, _Waiting] = {}

    def next_sequence(self) -> int:
        """Number for the next command, rising from 1."""
        self._sequence += 1
        return self._sequence

    def add(self, sequence: int, channel: str, data: bytes, now: float) -> "Future[Answer]":
        """Takes over a command, due at once; the future ends with its Answer, Refused or NoAnswer."""
        future: "Future[Answer]" = Future()
        self._waiting[sequence] = _Waiting(channel, data, now, now + self._limit, future)
        return future

    def take_due(self, now: float) -> List[Tuple[str, bytes]]:
        """(channel, data) to put on the wire now, oldest first. Those whose time is up are given up."""
        for sequence in [key for key, command in self._waiting.items() if now >= command.deadline]:
            future = self._waiting.pop(sequence).future
            _finish(future.set_exception, NoAnswer(f"no answer within {self._limit:g} s; see: tumble doctor"))
        due = [command for command in self._waiting.values() if now >= command.next]
        for command in due:
            command.next = now + self.RESEND
        return [(command.channel, command.data) for command in due]

    def receive(self, message: ack_t) -> None:
        """Picks out the answers to this client's commands."""
        for i in range(message.n):
            command = self._waiting.pop(message.sequence[i], None) if message.client[i] == self.client else None
            if command is None:
                continue
            answer = Answer(
                message.status[i], message.applied_step[i], message.body[i], message.generation[i], message.detail[i]
            )
            if answer.accepted:
                _finish(command.future.set_result, answer)
            else:
                _finish(command.future.set_exception, Refused(answer))

    def __len__(self) -> int:
        return len(self._waiting)


def _finish(set_outcome, outcome) -> None:  # type: ignore[no-untyped-def]
    try:
        set_outcome(outcome)
    except InvalidStateError:  # the caller cancelled it
        pass
