"""Starting and stopping: what is wrong is said at once, with the repair; what is right ends with a summary."""
import json
import pathlib
import time

import pytest
from server import SCENES, run_server, run_tumble

NO_ROUTE = ("unshare", "-n", "sh", "-c", 'ip link set lo up && exec "$@"', "sh")
SUMMARY = {"steps": int, "dt": float, "bodies": int, "wall_s": float, "cpu_s": float, "ms_per_step": float,
           "state_hash": str, "kinetic_energy": float, "potential_energy": float, "momentum": list,
           "angular_momentum": list, "deepest_penetration": float, "max_residual": float, "contacts": int}


def test_interrupt_ends_with_a_summary(free_bodies):
    assert free_bodies.stop() == 0
    assert "steps" in free_bodies.output


def test_start_prints_channels_and_what_to_paste(free_bodies):
    free_bodies.wait_for_output("TUMBLE_HEARTBEAT")
    for text in ("TUMBLE_STATE", "TUMBLE_FORCE", "tumble push", "spy", "python"):
        free_bodies.wait_for_output(text)


def test_summary_is_complete_and_the_same_twice():
    def run():
        done = run_server("--demo", "tumbling", "--fast", "--steps", 240, "--summary", "json")
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)
    first, second = run(), run()
    for key, kind in SUMMARY.items():
        assert isinstance(first[key], kind) or (kind is float and isinstance(first[key], int)), key
    assert first["steps"] == 240 and int(first["state_hash"], 16) != 0
    assert len(first["momentum"]) == len(first["angular_momentum"]) == 3
    assert first["state_hash"] == second["state_hash"]


@pytest.mark.parametrize("demo", ["cradle", "incline", "pile", "pyramid", "springs", "terrain", "tumbling"])
def test_every_demo_runs(demo):
    done = run_server("--demo", demo, "--fast", "--steps", 24, "--summary", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["steps"] == 24


def test_bad_scene_names_file_line_and_value(tmp_path):
    scene = tmp_path / "bad.sdf"
    lines = (SCENES / "free.sdf").read_text(encoding="utf-8").replace(">0.5</radius>", ">-0.5</radius>")
    scene.write_text(lines, encoding="utf-8")
    number = next(i for i, line in enumerate(lines.split("\n"), 1) if "-0.5" in line)
    done = run_server(scene)
    assert done.returncode == 2
    assert f"bad.sdf:{number}" in done.stderr and "radius" in done.stderr and "-0.5" in done.stderr


@pytest.mark.parametrize("arguments, text", [
    (["nowhere.sdf"], "nowhere.sdf"),
    (["--demo", "nothing"], "pyramid"),  # the list of those there are
    (["--no-such-option"], "--no-such-option"),
    (["--demo", "pile", "--rate", "-5"], "-5"),
    (["--demo", "pile", "--world", "a b"], "a b"),
])
def test_bad_arguments_are_named(arguments, text):
    done = run_server(*arguments, seconds=10)
    assert done.returncode == 2, done.stderr
    assert text in done.stderr


@pytest.mark.parametrize("url", ["nonsense", "foo://1.2.3.4:5", "udpm://239.255.76.67:99999"])
def test_bad_urls_are_named(url):
    done = run_server("--demo", "tumbling", "--lcm-url", url, seconds=10)
    assert done.returncode not in (0, -6, -11) and url in done.stderr


def test_no_route_fails_fast_with_the_repair():
    began = time.monotonic()
    done = run_server("--demo", "tumbling", wrapper=NO_ROUTE, seconds=10)
    assert done.returncode > 0
    assert "ip route" in done.stderr and "224.0.0.0/4" in done.stderr
    assert time.monotonic() - began < 1.0


def test_repair_of_a_missing_route_repairs_it():
    done = run_server("--demo", "tumbling", wrapper=NO_ROUTE, seconds=10)
    command = next(line.strip() for line in done.stderr.split("\n") if line.strip().startswith(("ip ", "sudo ip ")))
    again = ("unshare", "-n", "sh", "-c", f'ip link set lo up && {command.removeprefix("sudo ")} && exec "$@"', "sh")
    assert run_server("--demo", "tumbling", "--steps", 24, wrapper=again, seconds=20).returncode == 0


def test_repair_of_a_route_with_a_foreign_source_repairs_it():
    """A machine with a network card, its multicast routed to the loopback: kernels may drop what comes from the card's
    address."""
    prepare = ("ip link set lo up && ip link add near type veth peer name far && ip address add 10.1.1.1/24 dev near && "
               "ip link set near up && ip link set far up && ip route add 224.0.0.0/4 dev lo")
    done = run_server("--demo", "springs", "--steps", 2, seconds=10,
                      wrapper=("unshare", "-n", "sh", "-c", f'{prepare} && exec "$@"', "sh"))
    if done.returncode == 0:
        return  # this kernel does not mind
    command = next(line.strip() for line in done.stderr.split("\n") if line.strip().startswith(("ip ", "sudo ip ")))
    again = ("unshare", "-n", "sh", "-c", f'{prepare} && {command.removeprefix("sudo ")} && exec "$@"', "sh")
    assert run_server("--demo", "springs", "--steps", 24, wrapper=again, seconds=20).returncode == 0


def test_second_server_of_a_world_is_told(start, wire):
    first = start(SCENES / "free.sdf")
    beat = wire.next("HEARTBEAT", 10.0)
    second = start("--demo", "tumbling")
    second.wait_for_output(str(beat.pid))  # names the other one
    assert "TUMBLE" in second.output
    assert first.running


def test_two_worlds_share_a_bus(start):
    first, second = start(SCENES / "free.sdf", "--world", "A"), start(SCENES / "free.sdf", "--world", "B")
    for server, name in ((first, "A"), (second, "B")):
        server.wait_for_output(f"{name}_STATE")
        done = run_tumble("--world", name, "push", "ball", "--force", 1, 0, 0, "--seconds", 0.1)
        assert done.returncode == 0, done.stderr


def test_started_from_anywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_server("--demo", "cradle", "--fast", "--steps", 2).returncode == 0
    assert not list(pathlib.Path(tmp_path).iterdir())
