"""What is not a message is counted, answered where a client can be named, and never fatal."""
import os
import random
import socket
import struct

import pytest
from link import GROUP
from wire import MALFORMED


def malformed(wire):
    return wire.next("STATS").messages_malformed


def cuts(data):
    """Damaged versions of an encoded message, by name."""
    return {
        "empty": b"",
        "shorter than a fingerprint": data[:7],
        "only the fingerprint": data[:8],
        "cut in the middle": data[:len(data) // 2],
        "one byte short": data[:-1],
        "one byte long": data + b"\0",
        "another fingerprint": bytes(8) + data[8:],
        "garbage": random.Random(1).randbytes(200),
        "longer than any command": data + bytes(20000),
        "fragmented": data + bytes(200000),
    }


@pytest.mark.parametrize("channel", ["FORCE", "CONTROL"])
@pytest.mark.parametrize("name", list(cuts(bytes(64))))
def test_damaged_commands_are_counted(free_bodies, wire, channel, name):
    good = wire.force() if channel == "FORCE" else wire.control(wire.verb("PAUSE"))
    before = malformed(wire)
    wire.send_bytes(channel, cuts(good.encode())[name])
    wire.wait(lambda: malformed(wire) == before + 1, 3.0, "the count")
    assert free_bodies.running


@pytest.mark.parametrize("length", [-1, 0, 1 << 20, 0x7FFFFFFF])
def test_wrong_string_lengths(free_bodies, wire, length):
    command = wire.control(wire.verb("SPAWN"), name="NAME")
    data = command.encode()
    at = data.index(struct.pack(">i", 5) + b"NAME\0")
    before = malformed(wire)
    wire.send_bytes("CONTROL", data[:at] + struct.pack(">i", length) + data[at + 4:])
    wire.wait(lambda: malformed(wire) == before + 1, 3.0, "the count")
    assert free_bodies.running


def test_a_damaged_command_with_a_sender_is_answered(free_bodies, wire):
    command = wire.force()
    wire.send_bytes("FORCE", command.encode()[:-1])
    answer = wire.wait(lambda: wire.answers(command))[0]
    assert answer.status == MALFORMED and answer.detail


def test_garbage_datagrams_do_no_harm(free_bodies, wire):
    """Not even LCM: bytes sent to the group's port."""
    generator = random.Random(2)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for length in [0, 1, 3, 7, 8, 9, 20, 21, 300, 1400, 60000]:
            sender.sendto(generator.randbytes(length), GROUP)
        sender.sendto(b"LC02", GROUP)
        sender.sendto(b"LC02\0\0\0\1" + b"A" * 300, GROUP)      # a channel without an end
        sender.sendto(b"LC02\0\0\0\1" + b"TUMBLE_FORCE", GROUP)  # likewise
        sender.sendto(b"LC02\0\0\0\1" + b"TUMBLE_FORCE\0", GROUP)
    step = wire.next("STATE").step
    wire.next("STATE", condition=lambda m: m.step > step)
    assert free_bodies.running


def test_damage_is_logged_with_its_sender(free_bodies, wire):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.connect(GROUP)
        sender.send(b"LC02\0\0\0\1TUMBLE_FORCE\0damaged")
        free_bodies.wait_for_output(f"the last from {':'.join(map(str, sender.getsockname()))}")


def test_a_storm_does_not_stop_the_steps(free_bodies, wire):
    before = wire.next("HEARTBEAT")
    for _ in range(2000):
        wire.send_bytes("FORCE", os.urandom(50))
    after = wire.next("HEARTBEAT", condition=lambda m: m.step > before.step + 240)
    assert free_bodies.running and after.session == before.session
