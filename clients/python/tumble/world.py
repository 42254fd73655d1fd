"""A world served somewhere on the bus: its bodies, their states, and commands with the server's answers.

A thread of the World receives and resends; every method may be called from any other thread.
"""

from __future__ import annotations

import contextlib
import itertools
import threading
import time
from concurrent.futures import Future
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

import lcm

from .body import Body
from .bus import open_bus, resolve_url
from .commands import TYPES, Vector, choose, floats, make_control, make_named, set_motion, set_shape
from .contacts import ContactCollector, Contacts
from .errors import NoAnswer, NoServer, Refused, TumbleError, UnknownBody
from .messages import (
    ack_t,
    catalog_t,
    contacts_t,
    control_t,
    force_command_t,
    heartbeat_t,
    hits_t,
    packed_t,
    query_t,
    state_t,
    stats_t,
)
from .outbox import Answer, Outbox, Status
from .picture import BodyState, Description, Picture, State
from .query import Queries

PROTOCOL_VERSION = 1
QUEUE_CAPACITY = 2000
"""Messages of a channel that LCM keeps for us; its default of 30 is less than one burst of a large world. A quarter of
a second of all that a server sends: who can't keep up misses states then, instead of seeing all of them late."""
BATCH = 256
"""Messages that are handled in a row before answers and callbacks get their turn."""


class World:
    """Connects to the world `name` on the LCM bus `url` (default: LCM_DEFAULT_URL, else LCM's default).

    Waits `timeout` seconds for the server, for the picture of all bodies, and for every answer. Raises BusError,
    NoServer, ValueError (wrong URL). `bus`: an lcm.LCM that is open already, handled by this object from now on.
    """

    def __init__(
        self, name: str = "TUMBLE", url: str = "", timeout: float = 2.0, bus: Optional[lcm.LCM] = None
    ) -> None:
        self.name, self.timeout = name, timeout
        self.url = resolve_url(url) if bus is None else "the given bus"
        self._bus = bus or open_bus(self.url)
        self._picture = Picture()
        self._states: List[state_t] = []  # heard, but not yet merged
        self._packed: List[packed_t] = []
        self._outbox = Outbox(timeout)
        self._heartbeat: Optional[heartbeat_t] = None
        self._stats: Optional[stats_t] = None
        self._contacts = ContactCollector()
        self._questions = 0
        self._hits: Dict[int, hits_t] = {}
        self._callbacks: List[Callable[[State], object]] = []
        self._called_back: Tuple[int, int] = (0, -1)
        self.query = Queries(self)
        """Rays, moved shapes, places, closest points."""
        self._closing = False
        self._changed = threading.Condition()
        self._subscriptions = [self._subscribe(*entry) for entry in self._handlers()]
        self._thread = threading.Thread(target=self._receive, name=f"tumble {name}", daemon=True)
        self._thread.start()
        try:
            self._wait_for_server()
        except BaseException:
            self.close()
            raise

    # Bodies and states.

    def __getitem__(self, name: str) -> Body:
        """The body called `name`; UnknownBody (a KeyError) with similar names if there is none."""
        with self._changed:
            description = self._picture.find(name)
            if description is None or not self._picture.is_placed(description.id):
                raise UnknownBody(name, self.names)
            return Body(self, description)

    def name_of(self, id: int) -> str:
        """The name of the body with this index; "" if it is not known."""
        with self._changed:
            description = self._picture.descriptions.get(id)
            return description.name if description else ""

    def __contains__(self, name: object) -> bool:
        with self._changed:
            description = self._picture.find(str(name))
            return description is not None and self._picture.is_placed(description.id)

    def __iter__(self) -> Iterator[Body]:
        """All bodies, by rising id."""
        with self._changed:
            known = sorted(self._picture.descriptions.items())
        return iter([Body(self, description) for _, description in known])

    def __len__(self) -> int:
        with self._changed:
            return len(self._picture.descriptions)

    @property
    def names(self) -> List[str]:
        with self._changed:
            return list(self._picture.listing()[1])

    @property
    def state(self) -> State:
        """All bodies now, as numpy arrays; a copy."""
        with self._changed:
            return self._picture.snapshot()

    def states(self, timeout: Optional[float] = None) -> Iterator[State]:
        """Every new state, the newest if the caller is slow. NoServer if none comes for `timeout` seconds."""
        seen: Tuple[int, int] = (0, -1)
        while True:
            with self._changed:
                if not self._changed.wait_for(lambda: self._newest() != seen or self._closing, timeout):
                    raise NoServer(f"no state on {self.name}_STATE at {self.url} for {timeout} s")
                if self._closing:
                    return
                seen, state = self._newest(), self._picture.snapshot()
            yield state

    def _newest(self) -> Tuple[int, int]:
        return (self._picture.session, self._picture.step)

    @property
    def step_count(self) -> int:
        """Steps since the start of the session, as of the newest state."""
        return self._picture.step

    @property
    def time(self) -> float:
        """Simulated time of the newest state [s]."""
        return self._picture.time

    @property
    def state_hash(self) -> int:
        """Of the whole world at step_count, as an unsigned 64-bit number."""
        return self._picture.state_hash & (1 << 64) - 1

    @property
    def heartbeat(self) -> heartbeat_t:
        """The server's newest heartbeat_t."""
        assert self._heartbeat is not None  # the constructor waited for it
        return self._heartbeat

    @property
    def stats(self) -> Optional[stats_t]:
        """The server's newest stats_t; None before the first."""
        return self._stats

    def wait_for(self, condition: Callable[[], bool], timeout: Optional[float] = None) -> bool:
        """Looks at `condition` after every message until it holds (True) or the time is up (False)."""
        with self._changed:
            return self._changed.wait_for(condition, self.timeout if timeout is None else timeout)

    # Commands.

    def spawn(
        self,
        name: str,
        shape: str,
        size: Union[float, Vector],
        at: Vector,
        mass: Optional[float] = None,
        orientation: Vector = (1, 0, 0, 0),
        velocity: Vector = (0, 0, 0),
        angular_velocity: Vector = (0, 0, 0),
        friction: float = 0.5,
        restitution: float = 0.0,
        color: Vector = (0.55, 0.65, 0.75),
        type: str = "dynamic",
    ) -> Body:
        """A new body, returned when it has arrived.

        `size` [m]: of a "sphere" its radius, of a "capsule" (radius, straight length), of a "cylinder" or "cone"
        (radius, length along z), of a "box" its three edges, of an "ellipsoid" its three half axes.
        `mass` [kg]; None: from a density of 1000 kg/m^3. `type`: "dynamic", "static" or "kinematic".
        """
        command = make_control(control_t.VERB_SPAWN)
        command.name, command.body_type = name, choose("type", type, TYPES)
        command.mass = 0.0 if mass is None else float(mass)
        set_motion(command, at, orientation, velocity, angular_velocity)
        set_shape(command, shape, size, orientation)
        command.friction, command.restitution = float(friction), float(restitution)
        command.color = floats("color", color, 3) + [1.0]
        answer = self.send(command).result()

        def arrived() -> bool:
            found = self._picture.find(name)
            return found is not None and found.generation == answer.generation and self._picture.is_placed(found.id)

        if not self.wait_for(arrived):
            raise NoServer(f'"{name}" was accepted, but no state of it came within {self.timeout} s')
        return self[name]

    def remove(self, name: str, wait: bool = True) -> Any:
        """Takes a body out of the world."""
        return self[name].remove(wait=wait)

    def pause(self) -> Answer:
        """Stops simulated time; returns when the state at which it stands has arrived."""
        answer = self.send(make_control(control_t.VERB_PAUSE)).result()
        self.wait_for(lambda: self._picture.step >= answer.step)
        return answer

    def resume(self) -> Answer:
        """Lets simulated time run."""
        return self.send(make_control(control_t.VERB_RESUME)).result()

    def step(self, count: int = 1) -> State:
        """Runs `count` steps at full speed, then pauses; returns the whole state after them.

        What the network lost is asked for again. NoServer if the world stands still for the time limit.
        """
        command = make_control(control_t.VERB_STEP)
        command.count = count
        answer = self.send(command).result()
        end, last, deadline = answer.step + count, -1, 0.0
        while True:
            with self._changed:
                if self._changed.wait_for(lambda: self._picture.whole_step >= end, Outbox.RESEND):
                    return self._picture.snapshot()
                if self._picture.step != last:
                    last, deadline = self._picture.step, time.monotonic() + self.timeout
            if time.monotonic() > deadline:
                raise NoServer(f"step was accepted, but the world stays at step {last} instead of {end}")
            self._bus.publish(self.name + "_CONTROL", command.encode())  # answered again, and the whole state with it

    @contextlib.contextmanager
    def lock_step(self) -> Iterator["World"]:
        """For as long as the context lasts the client holds the clock: time passes in `step` alone."""
        self.pause()
        try:
            yield self
        finally:
            self.resume()

    def snapshot(self, name: str) -> Answer:
        """Keeps the world as it is under a name, in the server; at most 16 of them."""
        return self.send(make_named(control_t.VERB_SNAPSHOT, name)).result()

    def restore(self, name: str) -> Answer:
        """The world as it was at that snapshot, in a new session; returns when the new picture is complete."""
        return self._go_back(make_named(control_t.VERB_RESTORE, name))

    def reset(self) -> Answer:
        """The world as it was at the start, in a new session; returns when the new picture is complete."""
        return self._go_back(make_control(control_t.VERB_RESET))

    def _go_back(self, command: control_t) -> Answer:
        before = self._picture.session
        answer = self.send(command).result()
        self.wait_for(lambda: self._picture.session != before and self._picture.is_complete)
        return answer

    def stream_contacts(self, on: bool = True) -> Answer:
        """Streams the touching points on <WORLD>_CONTACTS, or stops that."""
        verb = control_t.VERB_CONTACTS_ON if on else control_t.VERB_CONTACTS_OFF
        return self.send(make_control(verb)).result()

    def contacts(self) -> Contacts:
        """The touching points of the newest step that the server has told; streams them from the first call on."""
        if self._contacts.newest is None:
            self.stream_contacts()
        if not self.wait_for(lambda: self._contacts.newest is not None):
            raise NoServer(f"no contacts on {self.name}_CONTACTS within {self.timeout} s")
        assert self._contacts.newest is not None
        return self._contacts.newest

    def on_state(self, callback: Callable[[State], object]) -> Callable[[], None]:
        """Calls `callback` with every new state, in this object's own thread; returns what ends that."""
        with self._changed:
            self._callbacks.append(callback)

        def cancel() -> None:
            with self._changed:
                self._callbacks.remove(callback)

        return cancel

    def ask(self, query: query_t) -> hits_t:
        """Puts a question (see Queries) until it is answered. Refused, NoAnswer."""
        with self._changed:
            self._questions += 1
            query.client, query.sequence = self._outbox.client, self._questions
            query.utime = time.time_ns() // 1000
            query.session = self._picture.session or self.heartbeat.session
        deadline = time.monotonic() + self.timeout
        while time.monotonic() < deadline:
            self._bus.publish(self.name + "_QUERY", query.encode())
            if self.wait_for(lambda: query.sequence in self._hits, Outbox.RESEND):
                answer = self._hits.pop(query.sequence)
                if answer.status != Status.APPLIED:
                    raise Refused(Answer(answer.status, -1, -1, -1, answer.detail))
                return answer
        raise NoAnswer(f"no answer to a query within {self.timeout:g} s; see: tumble doctor")

    def send(self, command: Union[force_command_t, control_t]) -> "Future[Answer]":
        """Numbers the command, sends it until it is answered; the future ends with an Answer, Refused or NoAnswer."""
        suffix = "_FORCE" if isinstance(command, force_command_t) else "_CONTROL"
        with self._changed:
            if self._closing:
                raise TumbleError("the world is closed")
            command.utime = time.time_ns() // 1000
            # Both tell the session; after a reset the state stream has it first, twice a second the heartbeat.
            command.session = self._picture.session or self.heartbeat.session
            command.client, command.sequence = self._outbox.client, self._outbox.next_sequence()
            future = self._outbox.add(command.sequence, self.name + suffix, command.encode(), time.monotonic())
            self._send_due()
        return future

    def _finish(self, future: "Future[Answer]", wait: bool) -> Union[Answer, "Future[Answer]"]:
        return future.result() if wait else future

    # The receiving thread.

    def close(self) -> None:
        """Stops listening. Commands that wait for an answer end with NoAnswer."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        if self._thread is not threading.current_thread():
            self._thread.join()
        for subscription in self._subscriptions:
            self._bus.unsubscribe(subscription)
        self._subscriptions = []
        with self._changed:
            self._outbox.take_due(float("inf"))

    def __enter__(self) -> "World":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _handlers(self) -> List[Tuple[str, Any, Callable[[Any], object]]]:
        return [
            ("_STATE", state_t, self._states.append),
            ("_PACKED", packed_t, self._packed.append),
            ("_CONTACTS", contacts_t, lambda message: self._contacts.merge(message)),
            ("_HITS", hits_t, self._keep_hits),
            ("_CATALOG", catalog_t, lambda message: self._picture.merge_catalog(message)),
            ("_HEARTBEAT", heartbeat_t, lambda message: setattr(self, "_heartbeat", message)),
            ("_STATS", stats_t, lambda message: setattr(self, "_stats", message)),
            ("_ACK", ack_t, lambda message: self._outbox.receive(message)),
        ]

    def _keep_hits(self, message: hits_t) -> None:
        if message.client == self._outbox.client:
            self._hits = {message.sequence: message}  # one question at a time

    def _subscribe(self, suffix: str, message_type: Any, use: Callable[[Any], object]) -> Any:
        def handle(_channel: str, data: bytes) -> None:
            if message_type is catalog_t and self._picture.has_settled(data):
                return
            try:
                message = message_type.decode(data)
            except Exception:  # whatever the generated decoder stumbles over: not a message of ours
                return
            with self._changed:
                use(message)
                self._changed.notify_all()

        subscription = self._bus.subscribe(self.name + suffix, handle)
        subscription.set_queue_capacity(QUEUE_CAPACITY)
        return subscription

    def _receive(self) -> None:
        slice_ms = int(1000 * Outbox.RESEND / 2)
        while not self._closing:
            self._bus.handle_timeout(slice_ms)
            for _ in range(BATCH):
                if self._bus.handle_timeout(0) <= 0:
                    break
            with self._changed:
                self._merge_states()
                self._send_due()
            self._call_back()

    def _merge_states(self) -> None:
        """What was heard at once is merged at once, publication by publication: a small message has its price."""
        for merge, heard in ((self._picture.merge_state, self._states), (self._picture.merge_packed, self._packed)):
            for _, messages in itertools.groupby(heard, key=lambda message: (message.session, message.utime)):
                merge(*messages)
                self._changed.notify_all()
            heard.clear()

    def _call_back(self) -> None:
        if self._callbacks and self._called_back != self._newest():
            self._called_back = self._newest()
            state = self.state
            for callback in list(self._callbacks):
                callback(state)

    def _send_due(self) -> None:
        for channel, data in self._outbox.take_due(time.monotonic()):
            self._bus.publish(channel, data)

    def _wait_for_server(self) -> None:
        if not self.wait_for(lambda: self._heartbeat is not None):
            channel = f"{self.name}_HEARTBEAT"
            raise NoServer(f"no server answers on channel {channel} at {self.url}; try: tumble doctor")
        if self.heartbeat.protocol_version != PROTOCOL_VERSION:
            version = self.heartbeat.protocol_version
            raise TumbleError(f"the server speaks protocol version {version}, this client {PROTOCOL_VERSION}")
        if not self.wait_for(lambda: self._picture.is_complete):
            heard, total = len(self), self._picture.num_bodies
            raise NoServer(f"the picture of {self.name} did not become complete ({heard} of {total} bodies)")

    def _body_state(self, description: Description) -> BodyState:
        with self._changed:
            current = self._picture.descriptions.get(description.id)
            if current is None or current.generation != description.generation:
                raise UnknownBody(description.name, self.names)
            return self._picture.body_state(description)

    def __repr__(self) -> str:
        return f"<World {self.name} at {self.url}: {len(self)} bodies, step {self.step_count}>"

