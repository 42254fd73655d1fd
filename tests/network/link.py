"""Two network namespaces joined by a cable: this process's own, and a far one. Loss by iptables' statistic match, a rate
by tbf; what neither can do (delay, duplicates, another order) is relay.py's."""
import os
import subprocess

GROUP = ("239.255.76.67", 7667)  # LCM's default
CABLE_URL = "udpm://{}:{}?ttl=1".format(*GROUP)
NEAR, FAR = "near0", "far0"
ADDRESSES = {NEAR: "10.77.0.1/24", FAR: "10.77.0.2/24"}


def run(*command):
    subprocess.run(list(map(str, command)), check=True, stdin=subprocess.DEVNULL)


class Far:
    """Another network namespace, which lives until close(). `far` goes before commands that are to run in it."""

    def __init__(self):
        self.holder = subprocess.Popen(["unshare", "-n", "sleep", "infinity"])
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == os.readlink("/proc/self/ns/net"):
            assert self.holder.poll() is None
        self.far = ("nsenter", "-t", str(self.holder.pid), "-n")
        run(*self.far, "ip", "link", "set", "lo", "up")
        run(*self.far, "ip", "route", "add", "224.0.0.0/4", "dev", "lo")

    def close(self):
        self.holder.kill()
        self.holder.wait()


class Link(Far):
    """A cable between this namespace and the far one, which carries multicast."""

    def __init__(self):
        super().__init__()
        run("ip", "link", "add", NEAR, "type", "veth", "peer", "name", FAR, "netns", self.holder.pid)
        for inside, name in (((), NEAR), (self.far, FAR)):
            run(*inside, "ip", "address", "add", ADDRESSES[name], "dev", name)
            run(*inside, "ip", "link", "set", name, "up")
            run(*inside, "ip", "route", "replace", "224.0.0.0/4", "dev", name)

    def set_loss(self, probability):
        """Of every datagram that crosses, in both directions."""
        for inside, other in (((), FAR), (self.far, NEAR)):
            run(*inside, "iptables", "-F", "INPUT")
            if probability > 0:  # what a host hears of itself never was on the cable
                run(*inside, "iptables", "-A", "INPUT", "-s", ADDRESSES[other].split("/")[0], "-p", "udp", "-m",
                    "statistic", "--mode", "random", "--probability", probability, "-j", "DROP")

    def set_rate(self, megabits):
        """From far to near; what doesn't fit 50 ms is lost."""
        run(*self.far, "tc", "qdisc", "replace", "dev", FAR, "root", "tbf", "rate", f"{megabits}mbit", "burst", "16kb",
            "latency", "50ms")

    def close(self):
        run("ip", "link", "del", NEAR)
        run("ip", "route", "replace", "224.0.0.0/4", "dev", "lo")
        super().close()
