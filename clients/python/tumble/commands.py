"""Commands and questions as messages: fields filled in from Python's values, checked before anything is sent."""

from __future__ import annotations

from typing import Any, List, Sequence, Union

from .messages import catalog_t, control_t, force_command_t, query_t

Vector = Sequence[float]
FRAMES = {"world": force_command_t.FRAME_WORLD, "body": force_command_t.FRAME_BODY}
SHAPES = {
    "sphere": catalog_t.SHAPE_SPHERE,
    "capsule": catalog_t.SHAPE_CAPSULE,
    "box": catalog_t.SHAPE_BOX,
    "cylinder": catalog_t.SHAPE_CYLINDER,
    "cone": catalog_t.SHAPE_CONE,
    "ellipsoid": catalog_t.SHAPE_ELLIPSOID,
}
TYPES = {"static": catalog_t.TYPE_STATIC, "dynamic": catalog_t.TYPE_DYNAMIC, "kinematic": catalog_t.TYPE_KINEMATIC}
_NUM_LENGTHS = {"sphere": 1, "capsule": 2, "box": 3, "cylinder": 2, "cone": 2, "ellipsoid": 3}


def make_control(verb: int) -> control_t:
    command = control_t()
    command.verb = verb
    command.orientation = [1.0, 0.0, 0.0, 0.0]
    return command


def make_named(verb: int, name: str) -> control_t:
    command = make_control(verb)
    command.name = name
    return command


def make_query(kind: int, origin: Vector = (0, 0, 0), direction: Vector = (0, 0, 0), length: float = 0.0) -> query_t:
    query = query_t()
    query.kind, query.length, query.ignored = kind, float(length), -1
    query.origin, query.direction = floats("origin", origin, 3), floats("direction", direction, 3)
    query.orientation = [1.0, 0.0, 0.0, 0.0]
    return query


def set_shape(
    message: Union[control_t, query_t], shape: str, size: Union[float, Vector], orientation: Vector
) -> None:
    message.shape_type = choose("shape", shape, SHAPES)
    lengths = [float(size)] if isinstance(size, (int, float)) else [float(length) for length in size]
    expected = _NUM_LENGTHS[shape]
    if len(lengths) != expected:
        raise ValueError(f"size: a {shape} has {expected} length(s), given were {len(lengths)}")
    message.size = lengths + [0.0] * (3 - expected)
    message.orientation = floats("orientation", orientation, 4)


def set_motion(command: control_t, at: Vector, orientation: Vector, velocity: Vector, angular_velocity: Vector) -> None:
    command.position, command.orientation = floats("at", at, 3), floats("orientation", orientation, 4)
    command.velocity = floats("velocity", velocity, 3)
    command.angular_velocity = floats("angular_velocity", angular_velocity, 3)


def floats(field: str, values: Vector, size: int) -> List[float]:
    numbers = [float(value) for value in values]
    if len(numbers) != size:
        raise ValueError(f"{field}: {size} numbers expected, given were {len(numbers)}")
    return numbers


def choose(field: str, word: str, words: Any) -> int:
    if word not in words:
        raise ValueError(f'{field}: "{word}" is not one of {", ".join(words)}')
    return int(words[word])
