"""The records of packed_t, 25 bytes a body: see protocol/README.md for their bits and the bounds of their errors."""

from __future__ import annotations

from typing import Tuple

import numpy as np
from numpy.typing import NDArray

from .messages import packed_t, state_t

RECORD = 25
"""Bytes of a body."""
GENERATIONS = 16
"""A record knows the generation modulo this."""
_FIELDS = [14, 1, 1, 1, 4, 20, 20, 20, 2, 13, 13, 13, 13, 13, 13, 13, 13, 13]
_FLAGS = (state_t.FLAG_RESTING, state_t.FLAG_CONTAINED, state_t.FLAG_WATCHED)
_TURN_LIMIT = np.sqrt(0.5)
_FRACTION_BITS, _EXPONENT_OFFSET = 7, 15

Ints = NDArray[np.int64]


def unpack(message: packed_t) -> Tuple[Ints, Ints, Ints, NDArray[np.float64]]:
    """(ids, generations modulo GENERATIONS, flags, n x 13 positions, orientations and velocities)."""
    records = np.frombuffer(bytes(message.records), np.uint8).reshape(message.n, RECORD)
    fields = _split(np.unpackbits(records, axis=1))
    flags = sum(fields[1 + i] * flag for i, flag in enumerate(_FLAGS))
    motion = np.empty((message.n, 13))
    for axis in range(3):
        motion[:, axis] = message.origin[axis] + fields[5 + axis] / ((1 << 20) - 1) * message.edge
    motion[:, 3:7] = _orientations(fields[8], np.stack(fields[9:12], axis=1))
    for column in range(6):
        motion[:, 7 + column] = _short_floats(fields[12 + column])
    return fields[0] + message.first_id, fields[4], np.asarray(flags), motion


def _split(bits: NDArray[np.uint8]) -> "list[Ints]":
    fields, at = [], 0
    for width in _FIELDS:
        weights = 1 << np.arange(width - 1, -1, -1, dtype=np.int64)
        fields.append(bits[:, at : at + width].astype(np.int64) @ weights)
        at += width
    return fields


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
