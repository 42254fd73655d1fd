"""World and Body against a fake server on a bus inside the process."""

import threading
import time
from typing import Iterator

import numpy as np
import pytest
from fake_server import FakeServer, make_catalog, make_state

from tumble import NoAnswer, NoServer, Refused, Status, UnknownBody, World
from tumble.messages import control_t, force_command_t


@pytest.fixture
def server() -> FakeServer:
    return FakeServer()


@pytest.fixture
def world(server: FakeServer) -> Iterator[World]:
    connected = threading.Event()

    def introduce() -> None:
        while not connected.wait(0.01):
            server.introduce({0: "floor", 1: "ball"})

    introduction = threading.Thread(target=introduce)
    introduction.start()
    try:
        world = World("FAKE", bus=server.bus, timeout=1.0)
    finally:
        connected.set()
        introduction.join()
    with world:
        yield world


def test_names_states_and_iteration(world: World) -> None:
    assert world.names == ["floor", "ball"] and len(world) == 2 and "ball" in world and "bell" not in world
    np.testing.assert_array_equal(world["ball"].position, [0, 0, 1])
    np.testing.assert_array_equal(world["ball"].orientation, [1, 0, 0, 0])
    assert [body.mass for body in world] == [2.0, 2.0]


def test_unknown_body_names_similar_ones(world: World) -> None:
    with pytest.raises(UnknownBody, match='no body is called "bell"; similar: ball'):
        world["bell"]


def test_push_says_what_it_means(world: World, server: FakeServer) -> None:
    answer = world["ball"].push(force=(0, 0, 50), seconds=0.5, at=(0.1, 0, 0), frame="body")
    assert answer.status == Status.APPLIED and answer.step == 7
    (command,) = server.commands
    assert (command.body, command.generation, command.session, command.sequence) == (1, 0, 1, 1)
    assert (tuple(command.force), tuple(command.point), command.duration) == ((0, 0, 50), (0.1, 0, 0), 0.5)
    assert command.frame == force_command_t.FRAME_BODY


def test_repeated_until_answered(world: World, server: FakeServer) -> None:
    server.on_command = lambda command: server.acknowledge(command) if len(server.commands) == 3 else None
    assert world["ball"].push(force=(1, 0, 0), seconds=1).accepted
    assert [command.sequence for command in server.commands] == [1, 1, 1]


def test_no_answer(world: World, server: FakeServer) -> None:
    server.on_command = lambda command: None
    with pytest.raises(NoAnswer):
        world.pause()


def test_refusal_raises_with_the_servers_reason(world: World, server: FakeServer) -> None:
    server.on_command = lambda command: server.acknowledge(command, 5, "force[2]: 1e+99 is beyond 1e+12")
    with pytest.raises(Refused, match="beyond 1e"):
        world["ball"].push(force=(0, 0, 1e99), seconds=1)


def test_wrong_arguments_never_leave(world: World, server: FakeServer) -> None:
    with pytest.raises(ValueError, match="force: 3 numbers"):
        world["ball"].push(force=(1, 2), seconds=1)
    with pytest.raises(ValueError, match='frame: "local"'):
        world["ball"].push(frame="local")
    with pytest.raises(ValueError, match="a capsule has 2"):
        world.spawn("c", "capsule", 1.0, at=(0, 0, 0))
    assert server.commands == []


def test_spawn_returns_the_body_when_it_has_arrived(world: World, server: FakeServer) -> None:
    def create(command: control_t) -> None:
        server.acknowledge(command, body=2)
        server.send("_CATALOG", make_catalog({0: "floor", 1: "ball", 2: command.name}, epoch=1))
        server.send("_STATE", make_state({2: command.position[2]}, step=8, catalog_epoch=1, num_bodies=3))

    server.on_command = create
    body = world.spawn("new", "sphere", 0.25, at=(0, 0, 4), mass=3)
    assert (body.name, body.position[2]) == ("new", 4.0)
    (command,) = server.commands
    assert (command.verb, list(command.size), command.mass) == (control_t.VERB_SPAWN, [0.25, 0, 0], 3.0)


def test_a_handle_of_a_removed_body_says_so(world: World, server: FakeServer) -> None:
    ball = world["ball"]
    server.send("_CATALOG", make_catalog({0: "floor"}, epoch=1, id_limit=2, end_id=2))
    assert world.wait_for(lambda: len(world) == 1)
    with pytest.raises(UnknownBody):
        ball.position


def test_states_yields_every_new_step(world: World, server: FakeServer) -> None:
    heights = []
    for state in world.states(timeout=1.0):
        heights.append(state["ball"].position[2])
        if len(heights) == 4:
            break
        server.send("_STATE", make_state({1: 10.0 * len(heights)}, step=len(heights), num_bodies=2))
    assert heights == [1.0, 10.0, 20.0, 30.0]


def test_pause_waits_for_the_state_at_which_it_stands(world: World, server: FakeServer) -> None:
    def stop(command: control_t) -> None:
        server.acknowledge(command)  # applied at step 7
        server.send("_STATE", make_state({1: 2.0}, step=7, num_bodies=2))

    server.on_command = stop
    world.pause()
    assert world.step_count == 7


def test_step_waits_for_the_new_state(world: World, server: FakeServer) -> None:
    def advance(command: control_t) -> None:
        server.acknowledge(command)  # applied at step 7
        server.send("_STATE", make_state({1: 2.0}, step=7 + command.count, num_bodies=2))

    server.on_command = advance
    world.step(5)
    assert world.step_count == 12


def test_damaged_messages_are_ignored(world: World, server: FakeServer) -> None:
    whole = make_state({1: 4.0}, step=3, num_bodies=2).encode()
    for data in (b"", b"rubbish", whole[:-4], b"\0" * 8 + whole[8:]):
        server.bus.publish("FAKE_STATE", data)
    server.bus.publish("FAKE_STATE", whole)
    assert world.wait_for(lambda: world.step_count == 3)
    assert world["ball"].position[2] == 4.0


def test_no_server_says_where_it_listened() -> None:
    start = time.monotonic()
    with pytest.raises(NoServer, match="no server answers on channel NOBODY_HEARTBEAT"):
        World("NOBODY", bus=FakeServer().bus, timeout=0.2)
    assert time.monotonic() - start < 2.0


def test_wrong_urls_are_named() -> None:
    for url, reason in (("udpm://10.0.0.1:7667", "not an IPv4 multicast"), ("udpm://?ttl=0&x=1", "unknown option x")):
        with pytest.raises(ValueError, match=reason):
            World(url=url)
