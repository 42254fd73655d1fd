"""Every row of the table in clients/troubleshooting.md: what the doctor finds, and that the command it names repairs it."""
import json
import pathlib
import threading

import lcm
import pytest
from server import ROOT, SCENES, run_tumble
from tumble.messages import heartbeat_t

PAGE = (ROOT / "clients/troubleshooting.md").read_text(encoding="utf-8")
LOOPBACK = "ip link set lo up"
ROUTE = "ip route add 224.0.0.0/4 dev lo src 127.0.0.1"
CABLE = ("ip link add {0} type veth peer name other && ip address add 10.78.0.1/24 dev {0} && ip link set {0} up && "
         "ip link set other up")
DROP = "iptables -A INPUT -p udp --dport 7667 -j DROP"
REJECT = "iptables -A OUTPUT -p udp --dport 7667 -j REJECT"


def in_namespace(*steps):
    """A network of its own, in which these commands are run first."""
    return ("unshare", "-n", "sh", "-c", " && ".join([*steps, 'exec "$@"']), "sh")


def examine(*arguments, wrapper=()):
    """(exit status, findings)"""
    done = run_tumble("--json", *arguments, "doctor", wrapper=wrapper)
    return done.returncode, json.loads(done.stdout)


def find(findings, topic, verdict):
    found = [finding for finding in findings if (finding["topic"], finding["verdict"]) == (topic, verdict)]
    assert found, findings
    return found[0]


def examine_network(*steps, url="udpm://"):
    done = run_tumble("--json", "--lcm-url", url, "doctor", "--network-only", wrapper=in_namespace(*steps))
    return done.returncode, json.loads(done.stdout)


@pytest.mark.parametrize("steps, text", [
    ((LOOPBACK,), "no route"),
    ((), "no route"),  # not even a loopback
    ((LOOPBACK, ROUTE, DROP), "did not come back"),
    ((LOOPBACK, CABLE.format("eth7"), "ip route add 224.0.0.0/4 dev lo"), "another interface's address"),
    ((LOOPBACK, ROUTE, REJECT), "refused"),
], ids=["no_route", "no_loopback", "dropped", "forged", "rejected"])
def test_a_broken_network_is_found_and_repaired(steps, text):
    assert text in PAGE
    status, findings = examine_network(*steps)
    if status == 0 and text == "another interface's address":
        pytest.skip("this kernel does not mind")
    fault = find(findings, "network", "fault")
    assert status == 1 and text in fault["text"]
    status, findings = examine_network(*steps, fault["repair"].removeprefix("sudo "))
    assert status == 0, findings
    find(findings, "network", "ok")


@pytest.mark.parametrize("steps, text, repair", [
    ((LOOPBACK, ROUTE), "stays on this host (lo)", ("ip route replace 224.0.0.0/4 dev eth7",)),
    ((LOOPBACK, CABLE.format("docker7"), "ip route add 224.0.0.0/4 dev docker7"), "looks virtual",
     ("ip route replace 224.0.0.0/4 dev eth7",)),
], ids=["loopback", "virtual"])
def test_a_route_that_leads_elsewhere_is_told(steps, text, repair):
    """ttl=1 asks for the local network. The page's repair, with the interface that is meant."""
    assert text in PAGE and "ip route replace 224.0.0.0/4 dev eth0" in PAGE
    url = "udpm://239.255.76.67:7667?ttl=1"
    status, findings = examine_network(*steps, url=url)
    warning = find(findings, "reach", "warning")
    assert status == 0 and text in warning["text"] and "ip route" in warning["repair"]
    meant = CABLE.format("eth7").replace("other", "another").replace("10.78", "10.79")
    _, findings = examine_network(*steps, meant, *repair, url=url)
    assert "eth7" in find(findings, "reach", "ok")["text"]


def test_ttl_0_in_a_container_is_told():
    """As Docker and podman mark their containers."""
    container = ("unshare", "-m", "sh", "-c", 'mount -t tmpfs none /run && touch /run/.containerenv && exec "$@"', "sh")
    arguments = ("--json", "doctor", "--network-only")
    warning = find(json.loads(run_tumble(*arguments, wrapper=container).stdout), "reach", "warning")
    assert "this container only" in warning["text"]
    url = warning["repair"].split("'")[1].removeprefix("LCM_DEFAULT_URL=")
    assert f"LCM_DEFAULT_URL={url}" in PAGE
    repaired = run_tumble("--lcm-url", url, *arguments, wrapper=container).stdout
    assert "this container only" not in repaired


def test_a_small_buffer_is_told():
    """By what this machine grants: a warning below a megabyte."""
    granted = int(pathlib.Path("/proc/sys/net/core/rmem_default").read_text(encoding="ascii"))
    _, findings = examine()
    finding = find(findings, "buffer", "ok" if granted >= 1 << 20 else "warning")
    assert f"{granted // 1024} kB" in finding["text"]
    if finding["verdict"] == "warning":
        assert finding["repair"].removeprefix("sudo ") in PAGE


def test_two_servers_of_a_name_are_told(start, wire):
    start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    second = start("--demo", "cradle")
    second.wait_for_output("TUMBLE_STATE", 10.0)
    status, findings = examine()
    fault = find(findings, "server", "fault")
    assert status == 1 and "share the name" in fault["text"] and fault["repair"].startswith("kill ")
    assert "--world TUMBLE_2" in fault["repair"]


def test_a_server_that_is_not_there_is_told(start, wire):
    status, findings = examine()
    assert status == 1 and find(findings, "server", "fault")["repair"] == "tumble-server --demo pile"
    server = start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    status, findings = examine("--world", "OTHER")
    assert status == 1 and find(findings, "server", "fault")["repair"].endswith("--world OTHER")
    status, findings = examine()
    assert status == 0 and find(findings, "answer", "ok")
    assert f"process {server.process.pid} " in find(findings, "server", "ok")["text"]


class HeartbeatsAlone:
    """What looks like a server and answers nothing."""

    def __init__(self, version):
        self.message = heartbeat_t()
        self.message.world, self.message.protocol_version, self.message.session = "TUMBLE", version, 1
        self.stopped = threading.Event()
        self.thread = threading.Thread(target=self.beat)

    def beat(self):
        bus = lcm.LCM()
        while not self.stopped.wait(0.2):
            bus.publish("TUMBLE_HEARTBEAT", self.message.encode())

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.stopped.set()
        self.thread.join()


@pytest.mark.parametrize("version, topic, text", [(99, "server", "protocol version"), (1, "answer", "answers nothing")])
def test_a_server_that_is_not_understood_is_told(version, topic, text):
    with HeartbeatsAlone(version):
        status, findings = examine()
    assert status == 1 and text in find(findings, topic, "fault")["text"]
