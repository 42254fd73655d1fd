"""A client that speaks the wire protocol itself: it sends exactly the messages a test wants, right or wrong, and keeps
everything it hears. The client libraries are tested elsewhere; what is tested with this is the server."""
import collections
import random
import time

import lcm
from tumble.messages import (ack_t, body_state_t, catalog_t, control_t, force_command_t, heartbeat_t, state_t, stats_t)

TYPES = {"STATE": state_t, "STATS": stats_t, "CATALOG": catalog_t, "HEARTBEAT": heartbeat_t, "ACK": ack_t}

Answer = collections.namedtuple("Answer", "client sequence status applied_step body generation detail session")

APPLIED, QUEUED, UNKNOWN_BODY, STALE_GENERATION, NOT_FINITE, OUT_OF_RANGE, EXPIRED, WRONG_SESSION = range(8)
QUEUE_FULL, UNKNOWN_VERB, MALFORMED = 8, 9, 13


class Wire:
    def __init__(self, world="TUMBLE"):
        self.world = world
        self.client = random.getrandbits(62) + 1
        self.sequence = 0
        self.heard = collections.defaultdict(list)  # what was heard, by the channel's part after the world's name
        self.lcm = lcm.LCM()
        for suffix, message_type in TYPES.items():
            self._listen(suffix, message_type)

    def _listen(self, suffix, message_type):
        def keep(_channel, data):
            self.heard[suffix].append(message_type.decode(data))
        self.lcm.subscribe(f"{self.world}_{suffix}", keep).set_queue_capacity(10000)

    def listen_to_body(self, index):
        self._listen(f"BODY_{index}", body_state_t)

    def wait(self, condition, seconds=5.0, what="what was awaited"):
        """Receives until condition() is true-ish and returns its value."""
        deadline = time.monotonic() + seconds
        while not (value := condition()):
            left = deadline - time.monotonic()
            assert left > 0, f"{what} did not come within {seconds} s; heard " + str(
                {suffix: len(messages) for suffix, messages in self.heard.items()})
            self.lcm.handle_timeout(max(1, int(min(left, 0.1) * 1000)))
        return value

    def listen(self, seconds):
        """Receives for a while."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            self.lcm.handle_timeout(max(1, int(left * 1000)))

    def next(self, suffix, seconds=5.0, condition=lambda message: True):
        """The next message of a channel, from now on, that meets the condition."""
        seen = len(self.heard[suffix])

        def find():
            return next((m for m in self.heard[suffix][seen:] if condition(m)), None)
        return self.wait(find, seconds, f"a message on {self.world}_{suffix}")

    # Commands

    def fill(self, command, **fields):
        """A command with this client's next sequence, the fields replaced by those given."""
        self.sequence += 1
        command.client, command.sequence = self.client, self.sequence
        for name, value in fields.items():
            assert hasattr(command, name), name
            setattr(command, name, value)
        return command

    def force(self, **fields):
        return self.fill(force_command_t(), **fields)

    def control(self, verb, **fields):
        command = control_t()
        command.orientation = [1.0, 0.0, 0.0, 0.0]
        return self.fill(command, verb=verb, **fields)

    def send(self, command):
        channel = "FORCE" if isinstance(command, force_command_t) else "CONTROL"
        self.send_bytes(channel, command.encode())

    def send_bytes(self, suffix, data):
        self.lcm.publish(f"{self.world}_{suffix}", data)

    def answers(self, command=None):
        """All answers heard so far, or those to one command."""
        answers = [Answer(a.client[i], a.sequence[i], a.status[i], a.applied_step[i], a.body[i], a.generation[i],
                          a.detail[i], a.session) for a in self.heard["ACK"] for i in range(a.n)]
        if command is None:
            return answers
        return [a for a in answers if (a.client, a.sequence) == (command.client, command.sequence)]

    def ask(self, command, seconds=5.0):
        """Sends a command once and returns its final answer."""
        self.send(command)

        def final():
            return next((a for a in self.answers(command) if a.status != QUEUED), None)
        return self.wait(final, seconds, "the answer")

    # Reading

    def bodies(self, seconds=5.0):
        """{name: (index, generation, mass)} of every body, from catalogue messages heard from now on."""
        seen = len(self.heard["CATALOG"])

        def complete():
            found, number = {}, None
            for m in self.heard["CATALOG"][seen:]:
                number = m.num_bodies
                found.update((m.name[i], (m.id[i], m.generation[i], m.mass[i])) for i in range(m.n))
            return found if number is not None and len(found) == number else None
        return self.wait(complete, seconds, "the whole catalogue")

    def motion(self, index, seconds=5.0, condition=lambda message: True):
        """(message, velocity, position) of the next STATE that holds the body and meets the condition."""
        m = self.next("STATE", seconds, lambda m: index in m.id[:m.n] and condition(m))
        i = list(m.id).index(index)
        return m, (m.vx[i], m.vy[i], m.vz[i]), (m.px[i], m.py[i], m.pz[i])

    @staticmethod
    def verb(name):
        return getattr(control_t, f"VERB_{name}")
