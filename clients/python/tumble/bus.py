"""The LCM bus: its URL, and whether multicast works, asked with plain sockets.

LCM's own self test blocks for 10 s when a firewall eats the echo, so it is never let near a broken network.
"""

from __future__ import annotations

import os
import select
import socket
import struct
import time
from typing import Optional, Tuple
from urllib.parse import parse_qsl, urlsplit

import lcm

from .errors import BusError

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
RECEIVE_BUFFER = 4 << 20
"""Asked for [B], as far as the kernel grants it: holds the bursts of a world of several thousand bodies."""


def resolve_url(url: str) -> str:
    """The URL itself, else LCM_DEFAULT_URL, else LCM's default."""
    return url or os.environ.get("LCM_DEFAULT_URL", "") or DEFAULT_URL


def open_bus(url: str) -> lcm.LCM:
    """Probes, then connects. Raises ValueError for a wrong URL, BusError if multicast does not work."""
    parts, default = urlsplit(url), urlsplit(DEFAULT_URL)
    if parts.scheme == "udpm":
        probe(*_group_and_port(url))
        if "recv_buf_size" not in parts.query and (granted := _granted_buffer()):
            url += f"{'&' if parts.query else '?'}recv_buf_size={granted}"
    try:
        return lcm.LCM(url)
    except RuntimeError as error:
        raise ValueError(f'LCM URL "{url}": {error}') from None


def probe(group: str, port: int, timeout: float = 0.3) -> None:
    """Sends one datagram to the group and waits for it to come back; BusError if it can't or doesn't."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender, socket.socket(
        socket.AF_INET, socket.SOCK_DGRAM
    ) as receiver:
        try:
            sender.connect((group, port))
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if hasattr(socket, "SO_REUSEPORT"):
                receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            receiver.bind(("", port))
            membership = struct.pack("=4sI", socket.inet_aton(group), socket.INADDR_ANY)
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            # A message on the channel of LCM's own self test, known again by its random end.
            datagram = b"LC02\0\0\0\0LCM_SELF_TEST\0" + os.urandom(16)
            sender.send(datagram)
        except OSError as error:
            reason = f"multicast to {group}:{port} does not work: {error.strerror}"
            raise BusError(reason, "ip route replace 224.0.0.0/4 dev lo src 127.0.0.1, or see: tumble doctor") from None
        if not _wait_for(receiver, datagram, timeout):
            raise BusError(f"a datagram sent to {group}:{port} did not come back", "tumble doctor names it")


def _wait_for(receiver: socket.socket, datagram: bytes, timeout: float) -> bool:
    end = time.monotonic() + timeout
    while (left := end - time.monotonic()) > 0:
        if select.select([receiver], [], [], left)[0] and receiver.recv(1 << 16) == datagram:
            return True
    return False


def _group_and_port(url: str) -> Tuple[str, int]:
    parts, default = urlsplit(url), urlsplit(DEFAULT_URL)
    try:
        group, port = parts.hostname or default.hostname, parts.port or default.port
        if not 224 <= socket.inet_aton(group)[0] <= 239:
            raise ValueError(f"{group} is not an IPv4 multicast address")
        unknown = [key for key, _ in parse_qsl(parts.query) if key not in ("ttl", "recv_buf_size", "transmit_only")]
        if unknown:
            raise ValueError(f"unknown option {unknown[0]}")
    except (OSError, ValueError) as error:
        raise ValueError(f'LCM URL "{url}": {error}') from None
    return group, port


def _granted_buffer() -> Optional[int]:
    try:
        with open("/proc/sys/net/core/rmem_max") as file:
            return min(int(file.read()), RECEIVE_BUFFER)
    except (OSError, ValueError):
        return None
