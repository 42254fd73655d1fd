"""Resending, answers and giving up, on a clock made of numbers."""

import pytest

from tumble import NoAnswer, Refused, Status
from tumble.messages import ack_t
from tumble.outbox import Outbox


def answer(outbox: Outbox, sequence: int, status: int, client: int = 0) -> ack_t:
    message = ack_t()
    message.n, message.client, message.sequence = 1, [client or outbox.client], [sequence]
    message.status, message.applied_step, message.detail = [status], [7], ["no such thing" if status > 1 else ""]
    message.body, message.generation = [3], [0]
    return message


def test_sent_at_once_then_every_50_ms_until_answered() -> None:
    outbox = Outbox(limit=2.0)
    future = outbox.add(1, "W_FORCE", b"push", now=10.0)
    times = [t / 1000 for t in range(10000, 10200) if outbox.take_due(t / 1000)]
    assert times == pytest.approx([10.0, 10.05, 10.1, 10.15], abs=0.0021)  # looked at every ms
    outbox.receive(answer(outbox, 1, Status.APPLIED))
    assert outbox.take_due(10.2) == [] and future.result(0).step == 7


def test_given_up_after_the_limit() -> None:
    outbox = Outbox(limit=2.0)
    future = outbox.add(1, "W_FORCE", b"push", now=0.0)
    assert outbox.take_due(0.0) and outbox.take_due(1.99) and not future.done()
    assert outbox.take_due(2.0) == [] and len(outbox) == 0
    with pytest.raises(NoAnswer):
        future.result(0)


def test_many_commands_take_turns() -> None:
    """A server that remembers 1024 numbers of a client must not forget one that is still on its way."""
    outbox, window = Outbox(limit=2.0), Outbox.WINDOW
    futures = [outbox.add(i + 1, "W_FORCE", b"push", now=0.0) for i in range(3 * window)]
    assert 4 * window <= 1024 and len(outbox.take_due(0.0)) == window
    for sequence in range(2, window + 1):
        outbox.receive(answer(outbox, sequence, Status.APPLIED))
    assert outbox.take_due(0.01) == [], "the first was lost, the window has not moved"
    assert len(outbox.take_due(0.05)) == 1
    outbox.receive(answer(outbox, 1, Status.APPLIED))
    assert len(outbox.take_due(0.06)) == window
    assert all(future.done() for future in futures[:window]) and not futures[window].done()


def test_all_that_wait_are_given_up_together_when_the_server_is_silent() -> None:
    outbox, window = Outbox(limit=2.0), Outbox.WINDOW
    futures = [outbox.add(i + 1, "W_FORCE", b"push", now=0.0) for i in range(3 * window)]
    outbox.take_due(0.0)
    outbox.receive(answer(outbox, 1, Status.APPLIED))  # the last that is heard of the server
    assert len(outbox.take_due(1.5)) == window
    assert len(outbox.take_due(2.0)) == window  # a second window
    outbox.take_due(3.5)
    assert futures[-1].done()  # the third is given up: 2 s of silence
    outbox.take_due(4.0)
    assert len(outbox) == 0 and all(future.done() for future in futures)


def test_a_refusal_carries_the_reason() -> None:
    outbox = Outbox(limit=2.0)
    future = outbox.add(1, "W_FORCE", b"push", now=0.0)
    outbox.take_due(0.0)
    outbox.receive(answer(outbox, 1, Status.OUT_OF_RANGE))
    with pytest.raises(Refused, match="^no such thing$") as refused:
        future.result(0)
    assert refused.value.answer.status == Status.OUT_OF_RANGE


def test_answers_to_others_and_repeated_answers_are_ignored() -> None:
    outbox = Outbox(limit=2.0)
    future = outbox.add(1, "W_FORCE", b"push", now=0.0)
    outbox.take_due(0.0)
    outbox.receive(answer(outbox, 1, Status.APPLIED, client=outbox.client ^ 2))
    outbox.receive(answer(outbox, 2, Status.APPLIED))
    assert not future.done()
    outbox.receive(answer(outbox, 1, Status.APPLIED))
    outbox.receive(answer(outbox, 1, Status.EXPIRED))
    assert future.result(0).accepted


def test_a_cancelled_future_is_no_trouble() -> None:
    outbox = Outbox(limit=2.0)
    outbox.add(1, "W_FORCE", b"push", now=0.0).cancel()
    outbox.take_due(0.0)
    outbox.receive(answer(outbox, 1, Status.APPLIED))
    assert len(outbox) == 0


def test_clients_differ_and_sequences_rise() -> None:
    one, two = Outbox(2.0), Outbox(2.0)
    assert one.client != two.client and 0 < one.client < 1 << 63
    assert [one.next_sequence() for _ in range(3)] == [1, 2, 3]
