"""A server without physics on a bus inside this process (memq://): sends what a test tells it to, notes commands."""

from typing import Callable, Dict, List, Optional, Union

import lcm

from tumble.messages import ack_t, catalog_t, control_t, force_command_t, heartbeat_t, state_t

MOTION = ("px", "py", "pz", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")


def make_state(bodies: Dict[int, float], step: int = 0, generation: int = 0, **fields: int) -> state_t:
    """A state_t in which body `id` is at z = bodies[id]."""
    message = state_t()
    message.utime, message.session, message.step, message.time = 1000 + step, 1, step, step / 240
    message.num_bodies, message.num_chunks = len(bodies), 1
    message.n, message.id = len(bodies), list(bodies)
    message.generation, message.flags = [generation] * message.n, [0] * message.n
    for name in MOTION:
        setattr(message, name, [1.0 if name == "qw" else 0.0] * message.n)
    message.pz = list(bodies.values())
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def make_catalog(names: Dict[int, str], generation: int = 0, **fields: int) -> catalog_t:
    """A catalog_t of one sphere for every id, over the whole range."""
    message, n = catalog_t(), len(names)
    message.utime, message.session = 1000, 1
    message.num_bodies = message.n = message.num_shapes = n
    message.id_limit = message.end_id = max(names, default=-1) + 1
    message.id, message.name, message.generation = list(names), list(names.values()), [generation] * n
    message.type, message.body_shapes, message.mass = [catalog_t.TYPE_DYNAMIC] * n, [1] * n, [2.0] * n
    for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz", "cx", "cy", "cz"):
        setattr(message, name, [0.0] * n)
    message.shape_body, message.shape_number, message.shape_vertices = list(names), [0] * n, [0] * n
    message.shape_type, message.size_x = [catalog_t.SHAPE_SPHERE] * n, [0.5] * n
    for name in ("size_y", "size_z", "shape_px", "shape_py", "shape_pz", "shape_qx", "shape_qy", "shape_qz"):
        setattr(message, name, [0.0] * n)
    message.shape_qw = [1.0] * n
    for name in ("friction", "restitution", "red", "green", "blue", "alpha"):
        setattr(message, name, [0.5] * n)
    for name, value in fields.items():
        setattr(message, name, value)
    return message


class FakeServer:
    def __init__(self, world: str = "FAKE") -> None:
        self.world, self.bus = world, lcm.LCM("memq://")
        self.commands: List[Union[force_command_t, control_t]] = []
        self.on_command: Callable[[Union[force_command_t, control_t]], None] = self.acknowledge
        self.bus.subscribe(f"{world}_FORCE", lambda _, data: self._note(force_command_t.decode(data)))
        self.bus.subscribe(f"{world}_CONTROL", lambda _, data: self._note(control_t.decode(data)))

    def _note(self, command: Union[force_command_t, control_t]) -> None:
        self.commands.append(command)
        self.on_command(command)

    def send(self, suffix: str, message: Union[state_t, catalog_t, heartbeat_t, ack_t]) -> None:
        self.bus.publish(self.world + suffix, message.encode())

    def introduce(self, names: Dict[int, str]) -> None:
        """What a client hears in its first seconds: heartbeat, catalogue, state."""
        heartbeat = heartbeat_t()
        heartbeat.session, heartbeat.protocol_version, heartbeat.dt = 1, 1, 1 / 240
        self.send("_HEARTBEAT", heartbeat)
        self.send("_CATALOG", make_catalog(names))
        self.send("_STATE", make_state({id: float(id) for id in names}))

    def acknowledge(
        self, command: Union[force_command_t, control_t], status: int = 0, detail: str = "", body: Optional[int] = None
    ) -> None:
        message = ack_t()
        message.n, message.client, message.sequence = 1, [command.client], [command.sequence]
        message.status, message.applied_step, message.detail = [status], [7 if status < 2 else -1], [detail]
        message.body, message.generation = [command.body if body is None else body], [command.generation]
        self.send("_ACK", message)
