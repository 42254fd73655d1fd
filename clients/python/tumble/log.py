"""Logs read into numpy: those of `tumble-server --record` and those of lcm-logger alike.

    from tumble import Log

    log = Log("run.lcm")
    times, energy = log.times, log.column("kinetic_energy")     # of the statistics
    for state in log.states():                                  # pictures of all bodies
        print(state.time, state.positions.shape)
    times, positions = log.track("ball")
"""

from __future__ import annotations

from typing import Any, Iterator, List, Optional, Tuple, Union

import lcm
import numpy as np
from numpy.typing import NDArray

from .messages import (
    catalog_t,
    control_t,
    force_command_t,
    packed_t,
    recording_t,
    state_t,
    stats_t,
    step_record_t,
)
from .picture import Array, Picture, State

_KINDS = {
    "_STATE": state_t,
    "_PACKED": packed_t,
    "_CATALOG": catalog_t,
    "_STATS": stats_t,
    "_FORCE": force_command_t,
    "_CONTROL": control_t,
    "_RECORDING": recording_t,
    "_STEP": step_record_t,
}


class Log:
    """The log at `path` of the world `world` (None: the first world in it). ValueError if there is none of it."""

    def __init__(self, path: str, world: Optional[str] = None) -> None:
        self.path = path
        self.world = world or self._find_world()
        self._stats: Optional[List[stats_t]] = None
        if world and not any(True for _ in self._messages(*_KINDS)):
            raise ValueError(f'{path}: nothing of a world "{world}" in it')

    def _find_world(self) -> str:
        for event in lcm.EventLog(self.path):
            for suffix, kind in _KINDS.items():
                if event.channel.endswith(suffix) and event.data[:8] == kind._get_packed_fingerprint():
                    return str(event.channel[: -len(suffix)])
        raise ValueError(f"{self.path}: no world of a tumble-server in it")

    def _messages(self, *suffixes: str) -> Iterator[Any]:
        kinds = {self.world + suffix: _KINDS[suffix] for suffix in suffixes}
        for event in lcm.EventLog(self.path):
            if event.channel in kinds:
                yield kinds[event.channel].decode(event.data)

    @property
    def recording(self) -> Optional[recording_t]:
        """What a recording of tumble-server begins with; None for other logs."""
        return next(self._messages("_RECORDING"), None)

    def commands(self) -> Iterator[Union[force_command_t, control_t]]:
        """In a recording with the step at which each was applied in `start_step`."""
        return self._messages("_FORCE", "_CONTROL")

    def hashes(self) -> Tuple[NDArray[np.int64], NDArray[np.uint64]]:
        """(steps, state hashes after them) of a recording."""
        records = [(record.step, record.state_hash & (1 << 64) - 1) for record in self._messages("_STEP")]
        return np.array([step for step, _ in records], np.int64), np.array([hash for _, hash in records], np.uint64)

    def states(self) -> Iterator[State]:
        """The picture of all bodies after every publication in the log."""
        picture, told = Picture(), (0, -1)
        for message in self._messages("_STATE", "_PACKED", "_CATALOG"):
            if isinstance(message, catalog_t):
                picture.merge_catalog(message)
                continue
            now = (message.session, message.step)
            if now != told and told[1] >= 0 and picture.is_complete:
                yield picture.snapshot()
            told = now
            (picture.merge_packed if isinstance(message, packed_t) else picture.merge_state)(message)
        if told[1] >= 0 and picture.is_complete:
            yield picture.snapshot()

    def track(self, name: str) -> Tuple[Array, Array]:
        """(times, positions) of one body in all states that have it."""
        rows = [(state.time, state[name].position) for state in self.states() if name in state]
        return np.array([time for time, _ in rows]), np.array([position for _, position in rows]).reshape(-1, 3)

    @property
    def times(self) -> Array:
        """Simulated time of the statistics in the log [s]."""
        return self.column("time")

    def column(self, field: str) -> Array:
        """A field of stats_t over all statistics in the log."""
        if self._stats is None:
            self._stats = list(self._messages("_STATS"))
        return np.array([getattr(message, field) for message in self._stats])
