"""What can go wrong for a client. Everything derives from TumbleError."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Iterable

if TYPE_CHECKING:
    from .outbox import Answer


class TumbleError(Exception):
    """Base of all errors of this package."""


class BusError(TumbleError):
    """Multicast does not work on this machine; `repair` is the command that repairs it."""

    def __init__(self, reason: str, repair: str) -> None:
        super().__init__(f"{reason}; repair: {repair}")
        self.repair = repair


class NoServer(TumbleError):
    """No server serves this world, or it fell silent."""


class NoAnswer(TumbleError):
    """The server did not answer a command in time; it may have been applied all the same."""


class UnknownBody(TumbleError, KeyError):
    """No body has this name."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        similar = difflib.get_close_matches(name, list(known))
        hint = f"; similar: {', '.join(similar)}" if similar else ""
        super().__init__(f'no body is called "{name}"{hint}')

    def __str__(self) -> str:  # KeyError would show quotes around the sentence
        return str(self.args[0])


class Refused(TumbleError):
    """The server refused a command; `answer` holds its status and its reason in words."""

    def __init__(self, answer: Answer) -> None:
        super().__init__(answer.text)
        self.answer = answer
