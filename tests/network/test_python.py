"""The Python package against a real server: what its documentation promises."""
import numpy as np
import pytest
from server import SCENES
from tumble import Log, Refused, World


@pytest.fixture(name="world")
def connect(start):
    """tests/scenes/ball.sdf: a ball of 1 kg that falls 1 m to the ground, restitution 0.6."""
    start(SCENES / "ball.sdf").wait_for_output("TUMBLE_STATE")
    with World(timeout=10.0) as world:
        yield world


def test_lock_step_holds_the_clock(world):
    with world.lock_step():
        begin, dt = world.step_count, world.heartbeat.dt
        before = world["ball"].state
        for i in range(20):
            world["ball"].push(force=(3, 0, 0), wait=False)
            state = world.step()
            assert state.step == begin + i + 1
        after = state["ball"]
        assert after.velocity[0] - before.velocity[0] == pytest.approx(20 * 3 * dt, rel=1e-12)
        assert world.step(100).step == begin + 120
    step = world.step_count
    assert world.wait_for(lambda: world.step_count > step, 5.0)


def test_all_bodies_in_one_read(world):
    state = world.state
    assert state.positions.shape == (len(world), 3) and state.orientations.shape == (len(world), 4)
    row = state.names.index("ball")
    np.testing.assert_array_equal(state["ball"].position, state.positions[row])
    assert np.allclose(np.linalg.norm(state.orientations, axis=1), 1)


def test_contacts(world):
    assert world.wait_for(lambda: world["ball"].resting, 20.0)
    contacts = world.contacts()
    assert len(contacts) == 1
    names = {world.name_of(int(contacts.body_a[0])), world.name_of(int(contacts.body_b[0]))}
    assert names == {"ball", "ground"}
    assert abs(contacts.normals[0, 2]) == pytest.approx(1)
    assert abs(contacts.points[0, 2]) < 1e-3
    assert abs(contacts.impulses[0, 2]) == pytest.approx(9.81 * world.heartbeat.dt, rel=1e-3)


def test_questions(world):
    with world.lock_step():
        x, y, z = world["ball"].position
        hit = world.query.ray((x, y, z + 5), (0, 0, -1))
        assert hit.body == "ball" and hit.distance == pytest.approx(4.9) and hit.normal[2] == pytest.approx(1)
        hit = world.query.ray((x, y, z + 5), (0, 0, -1), ignore="ball")
        assert hit.body == "ground" and hit.distance == pytest.approx(z + 5)
        assert world.query.ray((x, y, z + 5), (0, 0, -1), length=2) is None
        assert [found.body for found in world.query.ray_all((x, y, z + 5), (0, 0, -1))] == ["ball", "ground"]
        assert world.query.overlapping("sphere", 0.05, (x, y, z)) == ["ball"]
        assert world.query.in_box((x - 1, y - 1, z - 0.01), (x + 1, y + 1, z + 1)) == ["ball"]
        moved = world.query.cast("box", (0.2, 0.2, 0.2), (x, y, z + 2), (0, 0, -5))
        assert moved.body == "ball" and moved.distance == pytest.approx(1.8, abs=1e-6)
        assert world.query.closest("ball", "ground").distance == pytest.approx(z - 0.1)
        with pytest.raises(Refused, match="direction"):
            world.query.ray((0, 0, 1), (0, 0, 0))


def test_snapshot_and_restore(world):
    with world.lock_step():
        world.step(10)
        world.snapshot("here")
        kept, height = world.state_hash, world["ball"].position[2]
        world.step(50)
        assert world["ball"].position[2] != height
        world.restore("here")
        assert world["ball"].position[2] == height
        assert world.state_hash == kept
        with pytest.raises(Refused, match="here"):
            world.restore("nowhere")


def test_callbacks(world):
    heard = []
    cancel = world.on_state(heard.append)
    assert world.wait_for(lambda: len(heard) > 5, 5.0)
    cancel()
    assert all(a.step < b.step for a, b in zip(heard, heard[1:]))
    assert "ball" in heard[0].names


def test_refusals_are_exceptions_with_the_reason(world):
    with pytest.raises(Refused, match="name"):
        world.spawn("ball", "sphere", 0.1, at=(0, 0, 5))
    with pytest.raises(Refused, match='^no snapshot is called "x"; there is none$'):
        world.restore("x")
    with pytest.raises(Refused, match="force"):
        world["ball"].push(force=(1e300, 0, 0))


def test_a_packed_world_looks_the_same(start):
    """The same step of the same run in both encodings: no further apart than the standard says."""
    states = []
    for name, encoding in (("A", "exact"), ("B", "packed")):
        start("--demo", "pyramid", "--encoding", encoding, "--world", name).wait_for_output("_PACKED" if encoding == "packed" else "_STATE")
        with World(name, timeout=10.0) as world:
            world.pause()
            world.reset()
            world["row_19_0"].push(force=(3000, 500, 90000), torque=(0, 50, 9), seconds=0.1)  # the top one
            states.append(world.step(60))
            assert world["ground"].description.type == "static"
    exact, packed = states
    assert exact.names == packed.names and exact.step == packed.step == 60
    assert np.array_equal(exact.resting, packed.resting)
    assert np.abs(exact.positions - packed.positions).max() <= 64 / 2**21 * 1.00001
    turns = 2 * np.arccos(np.minimum(np.abs(np.sum(exact.orientations * packed.orientations, axis=1)), 1))
    assert turns.max() <= 6e-4
    for before, after in ((exact.velocities, packed.velocities), (exact.angular_velocities, packed.angular_velocities)):
        assert np.all(np.abs(before - after) <= np.maximum(np.abs(before) / 256, 2**-22))
    assert np.abs(exact.velocities).max() > 0.01


def test_logs_become_arrays(start, tmp_path):
    path = tmp_path / "run.lcm"
    server = start(SCENES / "ball.sdf", "--record", path)
    server.wait_for_output("TUMBLE_STATE")
    with World(timeout=10.0) as world:
        assert world.wait_for(lambda: world.step_count > 240, 20.0)
        world["ball"].push(force=(2, 0, 0), seconds=0.1)
    assert server.stop() == 0
    log = Log(str(path))
    assert log.world == "TUMBLE" and log.recording.scene.startswith("<?xml")
    times, positions = log.track("ball")
    assert len(times) > 5 and np.all(np.diff(times) > 0) and positions.shape == (len(times), 3)
    assert positions[:, 2].max() < 1.2 and positions[:, 2].min() > 0.09
    energy = log.column("kinetic_energy") + log.column("potential_energy")
    assert len(energy) == len(log.times) > 5
    steps, hashes = log.hashes()
    assert np.array_equal(steps, np.arange(1, len(steps) + 1)) and hashes.dtype == np.uint64
    assert [command.force[0] for command in log.commands()] == [2.0]
