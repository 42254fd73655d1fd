"""One body of a world, as a client holds it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .commands import FRAMES, Vector, choose, floats, make_control, set_motion
from .messages import control_t, force_command_t
from .picture import Array, BodyState, Description

if TYPE_CHECKING:
    from .world import World


class Body:
    """One body of a world. Properties are the newest the server told; commands wait for its answer.

    `wait=False` returns at once with a concurrent.futures.Future of the Answer: for controllers.
    """

    def __init__(self, world: "World", description: Description) -> None:
        self._world = world
        self.description = description

    @property
    def name(self) -> str:
        return self.description.name

    @property
    def mass(self) -> float:
        """[kg]; 0 for static and kinematic bodies."""
        return self.description.mass

    @property
    def state(self) -> BodyState:
        return self._world._body_state(self.description)

    @property
    def position(self) -> Array:
        """Centre of mass in the world frame [m]."""
        return self.state.position

    @property
    def orientation(self) -> Array:
        """(w, x, y, z), link axes to world."""
        return self.state.orientation

    @property
    def velocity(self) -> Array:
        """Of the centre of mass, world frame [m/s]."""
        return self.state.velocity

    @property
    def angular_velocity(self) -> Array:
        """World frame [rad/s]."""
        return self.state.angular_velocity

    @property
    def resting(self) -> bool:
        return self.state.resting

    def push(
        self,
        force: Vector = (0, 0, 0),
        seconds: float = 0.0,
        at: Vector = (0, 0, 0),
        torque: Vector = (0, 0, 0),
        frame: str = "world",
        start_step: int = 0,
        wait: bool = True,
    ) -> Any:
        """Force [N] and torque [N m] in the axes of `frame` ("world" or "body"), for simulated `seconds`.

        `seconds=0` is exactly one step. `at` is where the force acts: from the centre of mass, in the body's axes [m];
        it moves with the body.
        """
        command = force_command_t()
        command.body, command.generation = self.description.id, self.description.generation
        command.force, command.torque = floats("force", force, 3), floats("torque", torque, 3)
        command.point = floats("at", at, 3)
        command.frame = choose("frame", frame, FRAMES)
        command.duration, command.start_step = float(seconds), start_step
        return self._world._finish(self._world.send(command), wait)

    def torque(self, torque: Vector, seconds: float = 0.0, frame: str = "world", wait: bool = True) -> Any:
        """Torque [N m] in the axes of `frame`, for simulated `seconds`."""
        return self.push(torque=torque, seconds=seconds, frame=frame, wait=wait)

    def set(
        self,
        at: Vector,
        orientation: Vector = (1, 0, 0, 0),
        velocity: Vector = (0, 0, 0),
        angular_velocity: Vector = (0, 0, 0),
        wait: bool = True,
    ) -> Any:
        """Puts the body somewhere, with a velocity."""
        command = self._control(control_t.VERB_SET_STATE)
        set_motion(command, at, orientation, velocity, angular_velocity)
        return self._world._finish(self._world.send(command), wait)

    def remove(self, wait: bool = True) -> Any:
        """Takes the body out of the world."""
        return self._world._finish(self._world.send(self._control(control_t.VERB_REMOVE)), wait)

    def plot(self, on: bool = True, wait: bool = True) -> Any:
        """Streams the body on <WORLD>_BODY_<id>, where lcm-spy draws charts of it; or stops that."""
        verb = control_t.VERB_WATCH if on else control_t.VERB_UNWATCH
        return self._world._finish(self._world.send(self._control(verb)), wait)

    def _control(self, verb: int) -> control_t:
        command = make_control(verb)
        command.body, command.generation = self.description.id, self.description.generation
        return command

    def __repr__(self) -> str:
        return f"<Body {self.name!r} of {self._world.name}>"
