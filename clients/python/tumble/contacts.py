"""The touching points of one step, put together from the messages that carry them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Set, Tuple

import numpy as np
from numpy.typing import NDArray

from .messages import contacts_t

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contacts:
    """Row i of every array belongs to the same point. World frame, SI units."""

    step: int
    time: float
    body_a: NDArray[np.int64]
    """Index of body A."""
    body_b: NDArray[np.int64]
    points: Array
    normals: Array
    """From A to B."""
    separations: Array
    """[m]; < 0: overlap."""
    impulses: Array
    """On B during the last step [N s]."""

    def __len__(self) -> int:
        return len(self.body_a)


class ContactCollector:
    def __init__(self) -> None:
        self.newest: Optional[Contacts] = None
        """Of the newest step of which no message was lost."""
        self._at: Tuple[int, int, int] = (0, -1, 0)
        self._heard: Set[int] = set()
        self._parts: List[contacts_t] = []

    def merge(self, message: contacts_t) -> None:
        at = (message.session, message.step, message.utime)
        if message.session == self._at[0] and message.utime < self._at[2]:
            return
        if at != self._at:
            self._at, self._heard, self._parts = at, set(), []
        if message.chunk in self._heard:
            return
        self._heard.add(message.chunk)
        self._parts.append(message)
        if len(self._parts) == message.num_chunks:
            self.newest = self._join()

    def _join(self) -> Contacts:
        def column(name: str, kind: type = float) -> "NDArray[np.generic]":
            return np.concatenate([np.array(getattr(part, name), kind) for part in self._parts])

        def columns(*names: str) -> Array:
            return np.stack([column(name) for name in names], axis=1)

        first = self._parts[0]
        return Contacts(
            first.step,
            first.time,
            column("body_a", int),
            column("body_b", int),
            columns("px", "py", "pz"),
            columns("nx", "ny", "nz"),
            column("separation"),
            columns("jx", "jy", "jz"),
        )
