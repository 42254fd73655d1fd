"""Fixtures: servers and clients in the network namespace that in_namespace made for this run of pytest."""
import os
import socket

import pytest

from server import SCENES, Server
from wire import Wire


def pytest_configure(config):
    names = {name for _, name in socket.if_nameindex()}
    if names != {"lo"}:
        pytest.exit(f"this namespace has the interfaces {sorted(names)}: start pytest by tests/network/in_namespace", 3)
    os.environ.pop("LCM_DEFAULT_URL", None)


@pytest.fixture
def start(tmp_path):
    """start(arguments..., wrapper=()) -> Server; all of them are gone after the test."""
    servers = []

    def start_server(*arguments, wrapper=()):
        servers.append(Server(tmp_path / f"server{len(servers)}.log", *arguments, wrapper=wrapper))
        return servers[-1]
    yield start_server
    for server in servers:
        server.__exit__()


@pytest.fixture
def wire():
    return Wire()


@pytest.fixture
def free_bodies(start, wire):
    """A server with tests/scenes/free.sdf (nothing acts on its bodies), heard by `wire`."""
    server = start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    return server
