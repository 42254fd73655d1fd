"""Every command is answered, applied at most once, and refused with the reason."""
import math
import re

import pytest

from wire import (APPLIED, EXPIRED, NOT_FINITE, OUT_OF_RANGE, QUEUE_FULL, QUEUED, STALE_GENERATION, UNKNOWN_BODY,
                  UNKNOWN_VERB, WRONG_SESSION)

PUSH = (6.0, 0.0, 0.0)  # [N], for one step
MAX_WAITING = 4096  # commands that wait for their step


def ball_momentum(wire, ball):
    index, _, mass = ball
    last = wire.next("STATE").step
    return mass * wire.motion(index, condition=lambda m: m.step > last + 1)[1][0]


def test_one_answer_for_every_sending_and_one_effect(free_bodies, wire):
    ball = wire.bodies()["ball"]
    command = wire.force(body=ball[0], generation=ball[1], force=PUSH)
    for _ in range(3):
        wire.send(command)
    answers = wire.wait(lambda: len(wire.answers(command)) >= 3 and wire.answers(command))
    wire.listen(0.5)  # nothing more may come
    assert wire.answers(command) == [answers[0]] * 3 and answers[0].status == APPLIED
    h = wire.next("HEARTBEAT").dt
    assert ball_momentum(wire, ball) == pytest.approx(PUSH[0] * h, rel=1e-12)


def test_repeated_after_a_while(free_bodies, wire):
    ball = wire.bodies()["ball"]
    command = wire.force(body=ball[0], generation=ball[1], force=PUSH)
    first = wire.ask(command)
    for _ in range(20):  # others in between
        wire.ask(wire.force(body=ball[0], generation=ball[1]))
    wire.send(command)
    again = wire.wait(lambda: len(wire.answers(command)) == 2 and wire.answers(command)[1])
    assert again == first
    assert ball_momentum(wire, ball) == pytest.approx(PUSH[0] * wire.next("HEARTBEAT").dt, rel=1e-12)
    assert wire.next("STATS").commands_repeated == 1


def test_a_burst_is_answered_completely(free_bodies, wire):
    ball = wire.bodies()["ball"]
    commands = [wire.force(body=ball[0], generation=ball[1], force=PUSH) for _ in range(20)]
    for command in commands:
        wire.send(command)
    wire.wait(lambda: all(wire.answers(command) for command in commands))
    assert [[a.status for a in wire.answers(c)] for c in commands] == [[APPLIED]] * 20
    h = wire.next("HEARTBEAT").dt
    assert ball_momentum(wire, ball) == pytest.approx(20 * PUSH[0] * h, rel=1e-12)


def test_start_step_is_kept(free_bodies, wire):
    ball = wire.bodies()["ball"]
    start = wire.next("STATE").step + 120
    command = wire.force(body=ball[0], generation=ball[1], force=PUSH, start_step=start)
    answer = wire.ask(command)
    assert [a.status for a in wire.answers(command)] == [QUEUED, APPLIED]
    assert answer.applied_step == start


@pytest.mark.parametrize("fields, status, reason", [
    ({"body": 999}, UNKNOWN_BODY, "no body has the index 999"),
    ({"body": -1}, UNKNOWN_BODY, "no body has the index -1"),
    ({"generation": 77}, STALE_GENERATION, r"body \d+ has generation 1, not 77"),
    ({"force": (math.nan, 0.0, 0.0)}, NOT_FINITE, "force: a number is infinite or not a number"),
    ({"torque": (0.0, math.inf, 0.0)}, NOT_FINITE, "torque: a number is infinite or not a number"),
    ({"duration": -math.inf}, NOT_FINITE, "duration: a number is infinite or not a number"),
    ({"force": (1e300, 0.0, 0.0)}, OUT_OF_RANGE, r"force: 1e\+300 is not in -10+ .. 10+"),
    ({"duration": -1.0}, OUT_OF_RANGE, r"duration: -1 is not in 0 .. \d+"),
    ({"frame": 7}, OUT_OF_RANGE, "frame: 7 is not in 0 .. 1"),
    ({"expiry_step": 1}, EXPIRED, r"expiry_step: 1 is before step \d+, the earliest"),
    ({"session": 12345}, WRONG_SESSION, r"session: 12345 is not this one, \d+"),
])
def test_refused_forces_say_why_and_change_nothing(free_bodies, wire, fields, status, reason):
    ball = wire.bodies()["ball"]
    wire.next("STATE", condition=lambda m: m.step > 2)
    refused = wire.next("STATS").commands_refused
    command = wire.force(body=ball[0], generation=ball[1], force=PUSH)
    for name, value in fields.items():
        setattr(command, name, value)
    answer = wire.ask(command)
    assert (answer.status, answer.applied_step) == (status, -1)
    assert re.fullmatch(reason, answer.detail)
    assert ball_momentum(wire, ball) == 0.0
    assert wire.next("STATS").commands_refused == refused + 1


def test_unknown_verb(free_bodies, wire):
    answer = wire.ask(wire.control(99))
    assert answer.status == UNKNOWN_VERB and answer.detail


def test_removed_body_is_stale(free_bodies, wire):
    ball = wire.bodies()["ball"]
    assert wire.ask(wire.control(wire.verb("REMOVE"), body=ball[0], generation=ball[1])).status == APPLIED
    answer = wire.ask(wire.force(body=ball[0], generation=ball[1], force=PUSH))
    assert answer.status in (STALE_GENERATION, UNKNOWN_BODY)
    assert "ball" not in wire.bodies()


def test_spawned_body_is_listed_and_can_be_pushed(free_bodies, wire):
    command = wire.control(wire.verb("SPAWN"), name="new", body_type=1, shape_type=1, size=(0.5, 0.0, 0.0), mass=4.0,
                           position=(0.0, 0.0, 50.0))
    answer = wire.ask(command)
    assert answer.status == APPLIED, answer.detail
    body = wire.bodies()["new"]
    assert body == (answer.body, answer.generation, 4.0)
    wire.ask(wire.force(body=body[0], generation=body[1], force=PUSH))
    assert ball_momentum(wire, body) == pytest.approx(PUSH[0] * wire.next("HEARTBEAT").dt, rel=1e-12)


def test_name_taken(free_bodies, wire):
    answer = wire.ask(wire.control(wire.verb("SPAWN"), name="ball", body_type=1, shape_type=1, size=(0.5, 0.0, 0.0),
                                   mass=1.0))
    assert answer.status > QUEUED and "ball" in answer.detail


def test_a_full_queue_is_said_and_loses_nothing_that_was_accepted(free_bodies, wire):
    ball = wire.bodies()["ball"]
    start = wire.next("STATE").step + 1_000_000
    waiting = [wire.force(body=ball[0], generation=ball[1], start_step=start) for _ in range(MAX_WAITING)]
    for first in range(0, MAX_WAITING, 64):  # in portions that no socket drops
        portion = waiting[first:first + 64]
        for command in portion:
            wire.send(command)
        last = portion[-1]
        wire.wait(lambda: wire.answers(last), what="the answer to a portion")
    assert {answer.status for answer in wire.answers()} == {QUEUED}
    assert len(wire.answers()) == MAX_WAITING
    refused = wire.ask(wire.force(body=ball[0], generation=ball[1], start_step=start))
    assert (refused.status, refused.detail) == (QUEUE_FULL, f"too many commands wait: {MAX_WAITING}")
    # Those that wait do not shut out what acts at once.
    assert wire.ask(wire.force(body=ball[0], generation=ball[1], force=PUSH)).status == APPLIED
