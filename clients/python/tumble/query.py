"""Questions to the world as it stands between two steps: rays, moved shapes, places, closest points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, List, Optional, Union

import numpy as np
from numpy.typing import NDArray

from .commands import Vector, make_query, set_shape
from .messages import hits_t, query_t

if TYPE_CHECKING:
    from .world import World

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hit:
    """World frame, SI units."""

    body: str
    distance: float
    """Along the way; of closest points: between the bodies, < 0: overlap [m]."""
    point: Array
    """That was hit; of closest points: on the first body [m]."""
    normal: Array
    """Unit, out of what was hit; of closest points: from the first body to the second."""
    inside: bool
    """The way starts inside; distance is 0."""


class Queries:
    """`world.query`. Every method raises Refused for wrong values and NoAnswer if no answer comes."""

    def __init__(self, world: "World") -> None:
        self._world = world

    def ray(
        self, origin: Vector, direction: Vector, length: float = 0.0, ignore: Optional[str] = None
    ) -> Optional[Hit]:
        """What the ray meets first within `length` [m] (0: endless), or None. `ignore`: name of a body not looked at."""
        hits = self._ask(make_query(query_t.KIND_RAY, origin, direction, length), ignore)
        return hits[0] if hits else None

    def ray_all(
        self, origin: Vector, direction: Vector, length: float = 0.0, ignore: Optional[str] = None
    ) -> List[Hit]:
        """Everything that the ray meets, the nearest first, as much as fits one message."""
        return self._ask(make_query(query_t.KIND_RAY_ALL, origin, direction, length), ignore)

    def cast(
        self,
        shape: str,
        size: Union[float, Vector],
        at: Vector,
        way: Vector,
        orientation: Vector = (1, 0, 0, 0),
        ignore: Optional[str] = None,
    ) -> Optional[Hit]:
        """What a shape (as in World.spawn) meets first when it is moved by `way` [m] without turning, or None."""
        query = make_query(query_t.KIND_CAST, at, way)
        set_shape(query, shape, size, orientation)
        hits = self._ask(query, ignore)
        return hits[0] if hits else None

    def overlapping(
        self, shape: str, size: Union[float, Vector], at: Vector, orientation: Vector = (1, 0, 0, 0)
    ) -> List[str]:
        """Names of the bodies that share a point with the shape."""
        query = make_query(query_t.KIND_OVERLAP, at)
        set_shape(query, shape, size, orientation)
        return [hit.body for hit in self._ask(query, None)]

    def in_box(self, low: Vector, high: Vector) -> List[str]:
        """Names of the bodies whose axis-aligned bounds share a point with the box."""
        return [hit.body for hit in self._ask(make_query(query_t.KIND_BOX, low, high), None)]

    def closest(self, a: str, b: str) -> Optional[Hit]:
        """The closest points of two bodies; None if one has no shape."""
        query = make_query(query_t.KIND_CLOSEST)
        query.body_a, query.body_b = self._world[a].description.id, self._world[b].description.id
        hits = self._ask(query, None)
        return hits[0] if hits else None

    def _ask(self, query: query_t, ignore: Optional[str]) -> List[Hit]:
        if ignore is not None:
            query.ignored = self._world[ignore].description.id
        answer: hits_t = self._world.ask(query)
        return [
            Hit(
                self._world.name_of(answer.body[i]),
                answer.distance[i],
                np.array([answer.px[i], answer.py[i], answer.pz[i]]),
                np.array([answer.nx[i], answer.ny[i], answer.nz[i]]),
                bool(answer.inside[i]),
            )
            for i in range(answer.n)
        ]
