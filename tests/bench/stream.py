#!/usr/bin/env python3
"""What the stream costs and how fresh it is, for 10, 1000 and 10 000 bodies that all move: prints Markdown.

    tests/network/in_namespace PYTHON tests/bench/stream.py BUILD [BODIES...]

The server runs in a network namespace of its own, a cable (veth, datagrams of at most 1400 bytes) away from the
receiver. Rates of loss and ages are of a plain socket with the kernel's default buffer; `logger` is what lcm-logger, with
its queue of 30 messages, loses.
"""
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
os.environ["TUMBLE_BUILD"] = str(BUILD)
sys.path.insert(0, str(ROOT / "tests/network"))

import lcm  # noqa: E402
import numpy as np  # noqa: E402
from link import CABLE_URL, GROUP, Link  # noqa: E402
from server import Server  # noqa: E402
from tumble import World  # noqa: E402

SECONDS = 3.0
SCENE = """<sdf version="1.11"><world name="stream"><gravity>0 0 0</gravity><population name="body">
<model name="body"><link name="link">
<collision name="ball"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model>
<pose>0 0 0 0 0 0</pose><model_count>{count}</model_count>
<distribution><type>grid</type><rows>{rows}</rows><cols>{cols}</cols><step>1 1 1</step></distribution>
</population></world></sdf>"""


class Listener:
    """Everything on the group: counts, bytes, gaps in the sender's numbers, ages of states."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.bind(GROUP)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               struct.pack("=4sI", socket.inet_aton(GROUP[0]), socket.INADDR_ANY))
        self.socket.settimeout(0.1)

    def listen(self, seconds):
        datagrams, size, state_size, frames, ages, numbers = 0, 0, 0, {}, [], []
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                data = self.socket.recv(1 << 16)
            except socket.timeout:
                continue
            now = time.time()
            if data[:4] != b"LC02":
                continue
            numbers.append(struct.unpack(">I", data[4:8])[0])
            datagrams += 1
            size += len(data)
            channel, _, message = data[8:].partition(b"\0")
            if channel in (b"TUMBLE_STATE", b"TUMBLE_PACKED"):
                utime = struct.unpack(">q", message[8:16])[0]
                state_size += len(message)
                frames[utime] = frames.get(utime, 0) + 1
                ages.append(now - utime * 1e-6)
        sent = max(numbers) - min(numbers) + 1
        return {"datagrams": datagrams / seconds, "mbit": 8e-6 * size / seconds, "loss": 1 - datagrams / sent,
                "frames": len(frames) / seconds, "per_frame": np.mean(list(frames.values())),
                "state_bytes": state_size / len(frames), "p50": np.percentile(ages, 50), "p99": np.percentile(ages, 99)}


def logger_loss(folder):
    """Of the states: what lcm-logger writes against what was sent, by the numbers of the messages of each publication."""
    path = folder / "logger.lcm"
    with subprocess.Popen(["lcm-logger", "--quiet", "--force", f"--lcm-url={CABLE_URL}", path]) as logger:
        time.sleep(SECONDS)
        logger.send_signal(signal.SIGINT)
    frames = {}
    for event in lcm.EventLog(str(path)):
        if event.channel in ("TUMBLE_STATE", "TUMBLE_PACKED"):
            utime = struct.unpack(">q", event.data[8:16])[0]
            chunks = struct.unpack(">h", event.data[62:64])[0]
            frames.setdefault(utime, [0, chunks])[0] += 1
    whole = list(frames.values())[1:-1]
    return 1 - sum(heard for heard, _ in whole) / sum(sent for _, sent in whole)


def latency(count):
    """From a push to a state that shows it, in this client: median and 99th of sixty."""
    samples = []
    with World(url=CABLE_URL, timeout=30.0) as world:
        names = world.names
        for i in range(60):
            body = world[names[i % len(names)]]
            began = time.monotonic()
            answer = body.push(force=(0.001, 0, 0))
            index = body.description.id
            world.wait_for(lambda: world._picture._step[index] > answer.step, 30.0)  # pylint: disable=protected-access
            samples.append(time.monotonic() - began)
    return np.percentile(samples, 50), np.percentile(samples, 99)


def measure(link, folder, count, encoding):
    rows = max(1, int(count ** 0.5))
    scene = folder / f"{count}.sdf"
    scene.write_text(SCENE.format(count=count, rows=rows, cols=-(-count // rows)), encoding="utf-8")
    arguments = [scene, "--lcm-url", CABLE_URL, "--encoding", encoding]
    with Server(folder / "server.log", *arguments, wrapper=link.far) as server:
        server.wait_for_output("TUMBLE_HEARTBEAT", 60.0)
        with World(url=CABLE_URL, timeout=60.0) as world:  # all of them move and turn
            answers = [body.push(force=(body.mass, 0, 0), torque=(0, 0, 0.01 * body.mass), wait=False)
                       for body in world]
            for answer in answers:
                answer.result()
        listener = Listener()
        listener.listen(0.5)
        before = server.processor_seconds()
        heard = listener.listen(SECONDS)
        cpu = (server.processor_seconds() - before) / SECONDS
        listener.socket.close()
        logged = logger_loss(folder)
        p50, p99 = latency(count)
        server.stop()
    return (f"| {count} {encoding} | {heard['state_bytes'] / count:.1f} | {heard['mbit']:.2f} | {heard['frames']:.1f} | "
            f"{heard['per_frame']:.1f} | {100 * heard['loss']:.2f} | {100 * logged:.2f} | {1e3 * heard['p50']:.1f} / "
            f"{1e3 * heard['p99']:.1f} | {1e3 * p50:.1f} / {1e3 * p99:.1f} | {100 * cpu:.0f} |")


def lock_step(folder):
    program = BUILD / "tests/bench/lock_step_rate"
    if not program.exists():
        return []
    lines = ["", "Lock-step on the loopback: a client runs `step 1` and waits for the whole state after it.", "",
             "| scene | round trips a second | p50 / p99 [us] |", "|---|---|---|"]
    for demo in ("springs", "pyramid"):
        with Server(folder / "server.log", "--demo", demo) as server:
            server.wait_for_output("TUMBLE_HEARTBEAT", 20.0)
            done = subprocess.run([program, "4000"], check=True, capture_output=True, text=True, timeout=120)
            rate, p50, p99 = done.stdout.split()
            lines.append(f"| {demo} | {rate} | {p50} / {p99} |")
            server.stop()
    return lines


def main():
    lines = ["| bodies | state [B/body] | all [Mbit/s] | publications a second | datagrams each | lost [%] | logger [%] | "
             "age of state p50 / p99 [ms] | push to state p50 / p99 [ms] | server [% CPU] |", "|---" * 10 + "|"]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        lock = lock_step(folder)
        link = Link()
        try:
            for count in map(int, sys.argv[2:] or (10, 1000, 10000)):
                for encoding in ("exact", "packed"):
                    lines.append(measure(link, folder, count, encoding))
                    print(lines[-1], file=sys.stderr)
        finally:
            link.close()
    print("\n".join(lines + lock))


if __name__ == "__main__":
    main()
