#!/usr/bin/env python3
"""Carries a multicast group between this network namespace and another, badly: with loss, delay, duplicates and in
another order. Both namespaces route multicast to their loopback.

    relay.py PID [--loss P] [--duplicate P] [--delay SECONDS] [--jitter SECONDS] [--seed N]
"""
import argparse
import ctypes
import heapq
import os
import random
import select
import socket
import struct
import time

from link import GROUP


def enter(pid):
    """Moves this process into the network namespace of another."""
    libc = ctypes.CDLL(None, use_errno=True)
    with open(f"/proc/{pid}/ns/net", encoding="ascii") as namespace:
        if libc.setns(namespace.fileno(), 0) != 0:
            raise OSError(ctypes.get_errno(), "setns")


class End:
    """The group in one namespace."""

    def __init__(self):
        self.receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.receiver.bind(GROUP)
        self.receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                                 struct.pack("=4sI", socket.inet_aton(GROUP[0]), socket.INADDR_ANY))
        self.sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sender.connect(GROUP)
        self.own = self.sender.getsockname()

    def receive(self):
        """A datagram that somebody else sent, or None."""
        data, sender = self.receiver.recvfrom(1 << 16)
        return data if sender != self.own else None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pid", type=int)
    for name in ("loss", "duplicate", "delay", "jitter"):
        parser.add_argument(f"--{name}", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = random.Random(options.seed)
    here = End()
    enter(options.pid)
    there = End()
    print("ready", flush=True)
    parent, waiting, count = os.getppid(), [], 0
    while os.getppid() == parent:  # never outlives the test
        now = time.monotonic()
        timeout = max(0.0, waiting[0][0] - now) if waiting else 0.5
        for readable in select.select([here.receiver, there.receiver], [], [], timeout)[0]:
            source, target = (here, there) if readable is here.receiver else (there, here)
            data = source.receive()
            if data is None or generator.random() < options.loss:
                continue
            for _ in range(2 if generator.random() < options.duplicate else 1):
                count += 1
                due = time.monotonic() + options.delay + generator.random() * options.jitter
                heapq.heappush(waiting, (due, count, target, data))
        while waiting and waiting[0][0] <= time.monotonic():
            _, _, target, data = heapq.heappop(waiting)
            target.sender.send(data)


if __name__ == "__main__":
    main()
