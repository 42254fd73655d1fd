"""The client's picture of the world, merged from the server's messages in whatever order the network delivers them.

The rules: only what changed is sent, so what is not mentioned stays; newer steps win over older ones; a body is gone
when a catalogue of a newer epoch no longer lists it; a new session starts from nothing. The numbers live in arrays
indexed by body id, so that a message of a thousand bodies is merged without a loop.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from itertools import chain, compress
from typing import Any, Dict, Iterator, List, Optional, Sequence, Set, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from .messages import catalog_t, packed_t, state_t
from .packed import GENERATIONS, unpack

Array = NDArray[np.float64]
SHAPE_NAMES = {
    catalog_t.SHAPE_HALF_SPACE: "half_space",
    catalog_t.SHAPE_SPHERE: "sphere",
    catalog_t.SHAPE_CAPSULE: "capsule",
    catalog_t.SHAPE_BOX: "box",
    catalog_t.SHAPE_HULL: "convex_hull",
    catalog_t.SHAPE_CYLINDER: "cylinder",
    catalog_t.SHAPE_CONE: "cone",
    catalog_t.SHAPE_ELLIPSOID: "ellipsoid",
    catalog_t.SHAPE_TRIANGLE_MESH: "triangle_mesh",
    catalog_t.SHAPE_HEIGHT_FIELD: "height_field",
}
TYPE_NAMES = {catalog_t.TYPE_STATIC: "static", catalog_t.TYPE_DYNAMIC: "dynamic", catalog_t.TYPE_KINEMATIC: "kinematic"}


@dataclass(frozen=True)
class Shape:
    """One solid of a body; lengths in [m], poses from the centre of mass in link axes."""

    type: str
    size: Tuple[float, float, float]
    """sphere: radius; capsule: radius, straight length; cylinder, cone: radius, length; box: three edges; ellipsoid:
    three half axes; surface: of its bounds; else zeros."""
    position: Tuple[float, float, float]
    orientation: Tuple[float, float, float, float]
    friction: float
    restitution: float
    color: Tuple[float, float, float, float]
    num_vertices: int
    vertices: Dict[int, Tuple[float, float, float]] = field(default_factory=dict)
    """Of a hull, or the corners of a surface's bounds, by number, as far as heard of."""


@dataclass
class Description:
    """What a body is, from the catalogue."""

    id: int
    generation: int
    name: str
    type: str
    mass: float
    inertia: Array
    """3x3, about the centre of mass, link axes [kg m^2]."""
    center_of_mass: Array
    """In the link frame [m]."""
    num_shapes: int
    shapes: Dict[int, Shape] = field(default_factory=dict)
    """By number, as far as heard of."""

    @property
    def is_complete(self) -> bool:
        whole = all(len(shape.vertices) == shape.num_vertices for shape in self.shapes.values())
        return whole and len(self.shapes) == self.num_shapes


@dataclass(frozen=True)
class BodyState:
    """One body at one time. World frame, SI units; a copy that does not change."""

    name: str
    step: int
    """Step of the newest message about it: a body that rests is not sent at every step."""
    position: Array
    """Centre of mass [m]."""
    orientation: Array
    """(w, x, y, z), link axes to world."""
    velocity: Array
    """Of the centre of mass [m/s]."""
    angular_velocity: Array
    """[rad/s]"""
    resting: bool


@dataclass(frozen=True)
class State:
    """All bodies at one time: row i of every array belongs to names[i]. Copies that do not change."""

    step: int
    time: float
    names: List[str]
    ids: NDArray[np.int64]
    steps: NDArray[np.int64]
    positions: Array
    orientations: Array
    velocities: Array
    angular_velocities: Array
    resting: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __getitem__(self, name: str) -> BodyState:
        try:
            row = self.names.index(name)
        except ValueError:
            raise KeyError(name) from None
        return self._row(row)

    def __iter__(self) -> Iterator[BodyState]:
        return (self._row(row) for row in range(len(self)))

    def _row(self, row: int) -> BodyState:
        return BodyState(
            self.names[row],
            int(self.steps[row]),
            self.positions[row],
            self.orientations[row],
            self.velocities[row],
            self.angular_velocities[row],
            bool(self.resting[row]),
        )


_CATALOG_HEAD = struct.Struct(">qqqq")  # fingerprint, utime, session, epoch


class Picture:
    def __init__(self) -> None:
        self._clear(0)

    def _clear(self, session: int) -> None:
        self.session = session
        """0: nothing heard yet."""
        self.step, self.time, self.state_hash = -1, 0.0, 0
        self.whole_step = -1
        """Newest step of which a whole publication was heard, no message of it lost."""
        self._publication = 0  # utime of the newest ...
        self._chunks: Set[int] = set()  # ... and the numbers of its messages
        self.epoch, self.num_bodies = -1, -1
        self.descriptions: Dict[int, Description] = {}
        self._ids_by_name: Dict[str, int] = {}
        self._unfinished: Set[int] = set()  # described, but not with all shapes and vertices
        self._settled = -1  # epoch at which all bodies, and no others, were known
        self._listing: Optional[Tuple[NDArray[np.int64], List[str]]] = None  # of the described; None: changed since
        self._utime = 0
        # By id; generation -1: nobody. Columns of `motion`: position, orientation, velocity, angular velocity.
        self._generation = np.full(0, -1, np.int64)
        self._epoch = np.zeros(0, np.int64)
        self._step = np.full(0, -1, np.int64)
        self._flags = np.zeros(0, np.uint8)
        self._motion = np.zeros((0, 13))

    def merge_state(self, *messages: state_t) -> bool:
        """Messages of one publication. False if they were too old to say anything."""
        head = messages[0]
        if not self._adopt_session(head.session, head.utime):
            return False
        # A body that a newer epoch may have removed is not brought back by a message that was overtaken.
        may_create = head.catalog_epoch >= self.epoch
        self._note_publication(messages)
        ids = np.array(list(chain.from_iterable(m.id for m in messages)), np.int64)
        if len(ids) == 0:
            return True
        generations = np.array(list(chain.from_iterable(m.generation for m in messages)), np.int64)
        flags = np.array(list(chain.from_iterable(m.flags for m in messages)), np.int8).view(np.uint8)
        motion = np.concatenate(
            [(m.px, m.py, m.pz, m.qw, m.qx, m.qy, m.qz, m.vx, m.vy, m.vz, m.wx, m.wy, m.wz) for m in messages], axis=1
        ).T
        self._make_room(int(ids.max()) + 1)
        if may_create:
            self._create(ids, generations)
        self._place(head, ids, self._generation[ids] == generations, flags, motion)
        return True

    def merge_packed(self, *messages: packed_t) -> bool:
        """The same from packed_t. Only bodies that the catalogue has told: it knows their whole generation."""
        head = messages[0]
        if not self._adopt_session(head.session, head.utime):
            return False
        self._note_publication(messages)
        ids, generations, flags, motion = unpack(messages)
        if len(ids) == 0:
            return True
        self._make_room(int(ids.max()) + 1)
        known = (self._generation[ids] >= 0) & (self._generation[ids] % GENERATIONS == generations)
        self._place(head, ids, known, flags.astype(np.uint8), motion)
        return True

    def _note_publication(self, messages: Sequence[Union[state_t, packed_t]]) -> None:
        head = messages[0]
        self._note_epoch(head.catalog_epoch, head.num_bodies)
        if head.step >= self.step:
            self.step, self.time, self.state_hash = head.step, head.time, head.state_hash
        if head.utime > self._publication:
            self._publication, self._chunks = head.utime, set()
        if head.utime == self._publication:
            self._chunks.update(message.chunk for message in messages)
            if len(self._chunks) == head.num_chunks:
                self.whole_step = max(self.whole_step, head.step)

    def _place(self, head: Union[state_t, packed_t], ids: Any, known: Any, flags: Any, motion: Array) -> None:
        """Overwrites the rows of those that are known, unless they are newer."""
        self._epoch[ids[known]] = np.maximum(self._epoch[ids[known]], head.catalog_epoch)
        use = known & (self._step[ids] <= head.step)
        rows = ids[use]
        self._step[rows], self._flags[rows], self._motion[rows] = head.step, flags[use], motion[use]

    def merge_catalog(self, message: catalog_t) -> bool:
        """False if the message was too old to say anything."""
        if not self._adopt_session(message.session, message.utime) or message.epoch < self.epoch:
            return False
        self._note_epoch(message.epoch, message.num_bodies)
        self._remove_unlisted(message)
        self._merge_bodies(message)
        self._merge_shapes(message)
        self._merge_vertices(message)
        for id in self._unfinished & {*message.id, *message.shape_body, *message.vertex_body}:
            if self.descriptions[id].is_complete:
                self._unfinished.discard(id)
        return True

    def find(self, name: str) -> Optional[Description]:
        id = self._ids_by_name.get(name)
        return None if id is None else self.descriptions[id]

    def is_placed(self, id: int) -> bool:
        return id < len(self._step) and bool(self._step[id] >= 0)

    @property
    def is_complete(self) -> bool:
        """True if every body of the newest epoch is described with all its shapes, and placed."""
        known = self._generation >= 0
        return (
            int(np.count_nonzero(known)) == len(self.descriptions) == self.num_bodies
            and not self._unfinished
            and not np.any(self._step[known] < 0)
        )

    def has_settled(self, catalog: bytes) -> bool:
        """True if this catalogue's message can't tell anything new: every body of its epoch, and no other, is known.

        The server repeats the catalogue for those who join; reading all of it would cost as much as the states.
        """
        if len(catalog) < _CATALOG_HEAD.size:
            return False
        _, _, session, epoch = _CATALOG_HEAD.unpack_from(catalog)
        if (session, epoch) != (self.session, self.epoch):
            return False
        if self._settled != epoch and self.is_complete and np.all(self._epoch[self._generation >= 0] >= epoch):
            self._settled = epoch
        return self._settled == epoch

    def listing(self) -> Tuple[NDArray[np.int64], List[str]]:
        """(ids, names) of all that is described, by rising id; not to be changed."""
        if self._listing is None:
            ids = sorted(self.descriptions)
            self._listing = np.array(ids, np.int64), [self.descriptions[id].name for id in ids]
        return self._listing

    def body_state(self, description: Description) -> BodyState:
        motion, id = self._motion[description.id].copy(), description.id
        resting = bool(self._flags[id] & state_t.FLAG_RESTING)
        return BodyState(
            description.name, int(self._step[id]), motion[0:3], motion[3:7], motion[7:10], motion[10:13], resting
        )

    def snapshot(self) -> State:
        """A copy of everything that is described and placed, by rising id."""
        described, names = self.listing()
        placed = self._step[described] >= 0
        ids = described[placed]
        motion = self._motion[ids]
        return State(
            self.step,
            self.time,
            list(compress(names, placed)),
            ids,
            self._step[ids],
            motion[:, 0:3],
            motion[:, 3:7],
            motion[:, 7:10],
            motion[:, 10:13],
            (self._flags[ids] & state_t.FLAG_RESTING) != 0,
        )

    def _adopt_session(self, session: int, utime: int) -> bool:
        if session != self.session:
            if utime < self._utime:  # a straggler of the session before
                return False
            self._clear(session)
        self._utime = max(self._utime, utime)
        return True

    def _note_epoch(self, epoch: int, num_bodies: int) -> None:
        if epoch >= self.epoch:
            self.epoch, self.num_bodies = epoch, num_bodies

    def _make_room(self, size: int) -> None:
        more = size - len(self._generation)
        if more <= 0:
            return
        more = max(more, len(self._generation))
        self._generation = np.append(self._generation, np.full(more, -1, np.int64))
        self._epoch = np.append(self._epoch, np.zeros(more, np.int64))
        self._step = np.append(self._step, np.full(more, -1, np.int64))
        self._flags = np.append(self._flags, np.zeros(more, np.uint8))
        self._motion = np.append(self._motion, np.zeros((more, 13)), axis=0)

    def _create(self, ids: NDArray[np.int64], generations: NDArray[np.int64]) -> None:
        """Makes entries where the generation is newer than the known one."""
        for row in np.flatnonzero(self._generation[ids] < generations):
            id = int(ids[row])
            self._forget(id)
            self._generation[id] = generations[row]

    def _forget(self, id: int) -> None:
        self._generation[id], self._step[id], self._epoch[id] = -1, -1, 0
        description = self.descriptions.pop(id, None)
        self._unfinished.discard(id)
        self._listing = None
        if description and self._ids_by_name.get(description.name) == id:
            del self._ids_by_name[description.name]

    def _remove_unlisted(self, message: catalog_t) -> None:
        if message.first_id >= message.end_id:
            return
        end = len(self._generation) if message.end_id >= message.id_limit else message.end_id
        present = np.flatnonzero(self._generation[message.first_id : end] >= 0) + message.first_id
        for id in set(present.tolist()) - set(message.id):
            if self._epoch[id] < message.epoch:
                self._forget(id)

    def _merge_bodies(self, message: catalog_t) -> None:
        if message.n == 0:
            return
        ids, generations = np.array(message.id), np.array(message.generation)
        self._make_room(int(ids.max()) + 1)
        self._create(ids, generations)
        ours = self._generation[ids] == generations
        self._epoch[ids[ours]] = np.maximum(self._epoch[ids[ours]], message.epoch)
        for i in np.flatnonzero(ours).tolist():
            id = message.id[i]
            if id in self.descriptions:
                continue  # constant after creation
            ixy, ixz, iyz = message.ixy[i], message.ixz[i], message.iyz[i]
            inertia = np.array(
                [[message.ixx[i], ixy, ixz], [ixy, message.iyy[i], iyz], [ixz, iyz, message.izz[i]]]
            )
            self.descriptions[id] = Description(
                id,
                message.generation[i],
                message.name[i],
                TYPE_NAMES.get(message.type[i], "?"),
                message.mass[i],
                inertia,
                np.array([message.cx[i], message.cy[i], message.cz[i]]),
                message.body_shapes[i],
            )
            self._ids_by_name[message.name[i]] = id
            self._unfinished.add(id)
            self._listing = None

    def _merge_shapes(self, message: catalog_t) -> None:
        for i in range(message.num_shapes):
            description = self.descriptions.get(message.shape_body[i])
            if description is None or message.shape_number[i] in description.shapes:
                continue
            description.shapes[message.shape_number[i]] = Shape(
                SHAPE_NAMES.get(message.shape_type[i], "?"),
                (message.size_x[i], message.size_y[i], message.size_z[i]),
                (message.shape_px[i], message.shape_py[i], message.shape_pz[i]),
                (message.shape_qw[i], message.shape_qx[i], message.shape_qy[i], message.shape_qz[i]),
                message.friction[i],
                message.restitution[i],
                (message.red[i], message.green[i], message.blue[i], message.alpha[i]),
                message.shape_vertices[i],
            )

    def _merge_vertices(self, message: catalog_t) -> None:
        for i in range(message.num_vertices):
            description = self.descriptions.get(message.vertex_body[i])
            shape = description.shapes.get(message.vertex_shape[i]) if description else None
            if shape is not None and 0 <= message.vertex_number[i] < shape.num_vertices:
                vertex = (message.vertex_x[i], message.vertex_y[i], message.vertex_z[i])
                shape.vertices[message.vertex_number[i]] = vertex
