"""The records of packed_t, 25 bytes a body: see protocol/README.md for their bits and the bounds of their errors."""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from .messages import packed_t, state_t

RECORD = 25
"""Bytes of a body."""
GENERATIONS = 16
"""A record knows the generation modulo this."""
_WIDTHS = np.array([14, 1, 1, 1, 4, 20, 20, 20, 2, 13, 13, 13, 13, 13, 13, 13, 13, 13])
_ENDS = np.cumsum(_WIDTHS)
_BYTES = (_ENDS - _WIDTHS) // 8  # where a field begins; it ends within the four bytes from there
_SHIFTS = (32 - (_ENDS - 8 * _BYTES)).astype(np.uint32)
_MASKS = (1 << _WIDTHS).astype(np.uint32) - 1
_ID, _GENERATION, _POSITION, _LARGEST, _TURN, _VELOCITIES = 0, 4, slice(5, 8), 8, slice(9, 12), slice(12, 18)
_FLAGS = (state_t.FLAG_RESTING, state_t.FLAG_CONTAINED, state_t.FLAG_WATCHED)
_TURN_LIMIT = np.sqrt(0.5)
_FRACTION_BITS, _EXPONENT_OFFSET = 7, 15

Ints = NDArray[np.int64]


def unpack(messages: Sequence[packed_t]) -> Tuple[Ints, Ints, Ints, NDArray[np.float64]]:
    """(ids, generations modulo GENERATIONS, flags, n x 13 positions, orientations and velocities) of all of them."""
    records = np.frombuffer(b"".join(bytes(message.records) for message in messages), np.uint8)
    fields = _split(records.reshape(-1, RECORD))
    counts = [message.n for message in messages]
    first_ids = np.repeat([message.first_id for message in messages], counts)
    origins = np.repeat([message.origin for message in messages], counts, axis=0)
    edges = np.repeat([message.edge for message in messages], counts)
    flags = sum(fields[:, 1 + i] * flag for i, flag in enumerate(_FLAGS))
    motion = np.empty((len(fields), 13))
    motion[:, 0:3] = origins + fields[:, _POSITION] / ((1 << 20) - 1) * edges[:, None]
    motion[:, 3:7] = _orientations(fields[:, _LARGEST], fields[:, _TURN])
    motion[:, 7:13] = _short_floats(fields[:, _VELOCITIES])
    return fields[:, _ID] + first_ids, fields[:, _GENERATION], np.asarray(flags), motion


def _split(records: NDArray[np.uint8]) -> Ints:
    """A row a body, a column a field."""
    padded = np.zeros((len(records), RECORD + 3), np.uint32)
    padded[:, :RECORD] = records
    words = padded[:, :-3] << 24 | padded[:, 1:-2] << 16 | padded[:, 2:-1] << 8 | padded[:, 3:]  # from every byte on
    return (words[:, _BYTES] >> _SHIFTS & _MASKS).astype(np.int64)


def _orientations(largest: Ints, codes: Ints) -> NDArray[np.float64]:
    """Quaternions whose component number `largest` is the positive rest of the other three."""
    parts = codes / ((1 << 13) - 1) * 2 * _TURN_LIMIT - _TURN_LIMIT
    q = np.empty((len(codes), 4))
    rows = np.arange(len(codes))
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[largest]
    q[rows[:, None], others] = parts
    q[rows, largest] = np.sqrt(np.maximum(1 - np.sum(parts**2, axis=1), 0))
    return q


def _short_floats(codes: Ints) -> NDArray[np.float64]:
    """Sign, 5 bits of exponent, 7 of fraction."""
    exponent, fraction = codes >> _FRACTION_BITS & 31, codes & (1 << _FRACTION_BITS) - 1
    units = fraction + np.where(exponent > 0, 1 << _FRACTION_BITS, 0)
    sizes = np.ldexp(units.astype(np.float64), np.maximum(exponent, 1) - _EXPONENT_OFFSET - _FRACTION_BITS)
    return np.where(codes >> 12, -sizes, sizes)
