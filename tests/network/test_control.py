"""Pause, step and reset, to the bit."""
import json
import subprocess

from server import SCENES, run_tumble
from wire import APPLIED


def do(wire, verb, **fields):
    answer = wire.ask(wire.control(wire.verb(verb), **fields))
    assert answer.status == APPLIED, answer.detail
    return answer


def paused_step(wire):
    """The step a paused server stands at."""
    return wire.next("HEARTBEAT", condition=lambda m: m.paused).step


def hash_at(wire, step):
    """Steps a paused server to `step` and returns its state hash there."""
    now = paused_step(wire)
    assert now < step
    do(wire, "STEP", count=step - now)
    beat = wire.next("HEARTBEAT", 20.0, lambda m: m.paused and m.step >= step)
    assert beat.step == step
    return beat.state_hash


def test_pause_stands_still(free_bodies, wire):
    do(wire, "PAUSE")
    first = wire.next("HEARTBEAT", condition=lambda m: m.paused)
    wire.listen(1.2)
    last = wire.next("HEARTBEAT")
    assert (first.step, first.state_hash) == (last.step, last.state_hash)
    do(wire, "RESUME")
    wire.next("STATE", condition=lambda m: m.step > last.step)


def test_step_does_exactly_so_many(free_bodies, wire):
    do(wire, "PAUSE")
    before = paused_step(wire)
    do(wire, "STEP", count=7)
    wire.listen(1.2)
    assert paused_step(wire) == before + 7


def test_a_repeated_control_is_answered_again_and_done_once(free_bodies, wire):
    do(wire, "PAUSE")
    before = paused_step(wire)
    spawn = wire.control(wire.verb("SPAWN"), name="new", body_type=1, shape_type=1, size=(0.5, 0.0, 0.0), mass=4.0)
    step = wire.control(wire.verb("STEP"), count=7)
    remove = wire.control(wire.verb("REMOVE"), body=wire.bodies()["ball"][0], generation=wire.bodies()["ball"][1])
    for command in (spawn, step, remove):
        for _ in range(3):
            wire.send(command)
        wire.wait(lambda: len(wire.answers(command)) >= 3, what="three answers")
    wire.listen(1.2)
    for command in (spawn, step, remove):
        answers = wire.answers(command)
        assert answers == [answers[0]] * 3 and answers[0].status == APPLIED, answers
    assert paused_step(wire) == before + 7
    bodies = wire.bodies()
    assert "ball" not in bodies and bodies["new"][:2] == (wire.answers(spawn)[0].body, wire.answers(spawn)[0].generation)


def test_reset_starts_again_with_the_same_bits(start, wire):
    start("--demo", "tumbling")
    wire.next("HEARTBEAT", 10.0)
    do(wire, "PAUSE")
    session = wire.next("HEARTBEAT").session
    first = hash_at(wire, 1000)
    do(wire, "RESET")
    beat = wire.next("HEARTBEAT", condition=lambda m: m.session != session)
    assert beat.step < 1000
    if not beat.paused:
        do(wire, "PAUSE")
    assert hash_at(wire, 1000) == first


def test_pushes_are_part_of_what_a_reset_takes_back(free_bodies, wire):
    ball = wire.bodies()["ball"]
    do(wire, "PAUSE")
    session = wire.next("HEARTBEAT").session
    wire.send(wire.force(body=ball[0], generation=ball[1], force=(0.0, 0.0, 5.0), duration=100.0))
    hash_at(wire, paused_step(wire) + 100)
    do(wire, "RESET")
    wire.next("HEARTBEAT", condition=lambda m: m.session != session)
    if not wire.next("HEARTBEAT").paused:
        do(wire, "PAUSE")
    do(wire, "STEP", count=10)
    assert wire.motion(ball[0])[1] == (0.0, 0.0, 0.0)


def test_command_line(start, wire):
    start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    for arguments in (["pause"], ["step", "5"], ["reset"], ["resume"], ["list"],
                      ["spawn", "box", "--name", "new", "--size", "1", "1", "1", "--at", "0", "0", "9"], ["remove", "new"],
                      ["torque", "box", "--torque", "0", "0", "1", "--seconds", "0.1"]):
        done = run_tumble(*arguments)
        assert done.returncode == 0, (arguments, done.stdout, done.stderr)
    assert {"ball", "box"} <= set(run_tumble("list").stdout.split())


def test_command_line_names_what_is_wrong(free_bodies, wire):
    done = run_tumble("push", "nobody", "--force", 0, 0, 1, "--seconds", 0.1)
    assert done.returncode != 0 and "nobody" in done.stderr
    done = run_tumble("--world", "ELSEWHERE", "pause")
    assert done.returncode != 0 and "ELSEWHERE" in done.stderr


def test_words_are_completed(tmp_path):
    """As bash does it: the beginning of a subcommand, and an option of one."""
    script = tmp_path / "completion"
    script.write_text(run_tumble("completion").stdout, encoding="utf-8")

    def complete(*words):
        ask = f"source {script}; COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _tumble; echo ${{COMPREPLY[*]}}"
        return subprocess.run(["bash", "-c", ask], check=True, capture_output=True, text=True).stdout.split()
    assert complete("tumble", "pau") == ["pause"]
    assert "--seconds" in complete("tumble", "push", "ball", "--s")
    assert complete("tumble", "--js") == ["--json"]


def test_every_subcommand_speaks_json(free_bodies, wire, tmp_path):
    for arguments in (["list"], ["pause"], ["step", "3"], ["snapshot", "a"], ["restore", "a"], ["reset"], ["resume"],
                      ["push", "ball", "--force", "0", "0", "1", "--seconds", "0.1"], ["watch", "ball", "--count", "2"], ["doctor"],
                      ["contacts", "on"], ["plot", "ball"], ["record", tmp_path / "run.lcm", "--seconds", "0.5"],
                      ["remove", "ball"]):
        done = run_tumble("--json", *arguments)
        assert done.returncode == 0, (arguments, done.stderr)
        decoder, text, found = json.JSONDecoder(), done.stdout.strip(), 0
        while text:
            _, end = decoder.raw_decode(text)
            text, found = text[end:].strip(), found + 1
        assert found >= 1, arguments


def test_a_refusal_is_one_sentence(free_bodies):
    done = run_tumble("restore", "x")
    assert (done.returncode, done.stdout, done.stderr) == (1, "", 'tumble: x: refused: no snapshot is called "x"; there is none\n')
