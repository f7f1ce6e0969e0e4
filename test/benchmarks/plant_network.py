# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Try the profile for a plant network between two machines: ``python test/benchmarks/plant_network.py`` (Linux, as root).

The machines are network namespaces with shared memory of their own, so that nothing reaches the real network.  Two networks join them: ``plant``,
which the profile names, and ``office``, which it does not.  A node runs on the first machine, a player and a subscriber on the second; each finds
the other by its address in ROS_STATIC_PEERS, without multicast.  Listed are the sockets of both programs by address, and how many outputs of the
node the subscriber has heard.

At LOCALHOST, rmw_fastrtps adds sockets for sending to those that the profile opens, on all interfaces.  Whether anything reads them is tried: the
second machine sends a datagram over the office network to every socket of the node that it can reach there, and the last column counts those that
still have it in their queues a second later.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import click

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from recordings import steady_log  # noqa: E402
from sockets import open_sockets  # noqa: E402

from bearing_sim.cli.reporting import print_rows  # noqa: E402
from bearing_sim.ros.network import FOLDER  # noqa: E402

_MACHINES = {"first": ("198.51.100.1", "203.0.113.1"), "second": ("198.51.100.2", "203.0.113.2")}  # addresses for documents, RFC 5737
_LISTENER = """
import rclpy, time
from sensor_msgs.msg import JointState
rclpy.init()
node, heard = rclpy.create_node("listener"), []
node.create_subscription(JointState, "bearing_joints", heard.append, 10)
end = time.monotonic() + 60.0
while len(heard) < 100 and time.monotonic() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
print(len(heard), flush=True)
"""


_SENDER = """
import socket, sys
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
    for port in sys.argv[2:]:
        sender.sendto(b"RTPS", (sys.argv[1], int(port)))
"""


def _run(*words: str) -> None:
    subprocess.run(words, check=True)


def _build() -> None:
    """Make two namespaces that two networks join."""
    first, second = (f"bearing_{name}" for name in _MACHINES)
    for namespace in (first, second):
        _run("ip", "netns", "add", namespace)
    for network in ("plant", "office"):
        _run("ip", "link", "add", network, "netns", first, "type", "veth", "peer", "name", network, "netns", second)
    for name, (plant, office) in _MACHINES.items():
        inside = ("ip", "-n", f"bearing_{name}")
        for interface, address in (("plant", plant), ("office", office)):
            _run(*inside, "address", "add", f"{address}/24", "dev", interface)
        for interface in ("lo", "plant", "office"):
            _run(*inside, "link", "set", interface, "up")


def _start(machine: str, folder: Path, profile: Path, *words: str, **options) -> subprocess.Popen:
    """Start a program on a machine."""
    peers = [plant for name, (plant, _) in _MACHINES.items() if name != machine]
    variables = {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_STATIC_PEERS": ";".join(peers),
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(profile),
        "FASTDDS_DEFAULT_PROFILES_FILE": str(profile),
        "ROS_DOMAIN_ID": "7",
    }
    apart = ("ip", "netns", "exec", f"bearing_{machine}", "unshare", "--mount", "sh", "-c", 'mount -t tmpfs none /dev/shm && exec "$@"', "sh")
    return subprocess.Popen([*apart, *words], cwd=folder, env=os.environ | variables, **options)


def _queues(pid: int) -> Iterator[tuple[int, bool]]:
    """Yield the port of each datagram socket in the network of a process, and whether something waits in it to be read."""
    for line in Path(f"/proc/{pid}/net/udp").read_text().splitlines()[1:]:
        words = line.split()
        yield int(words[1].rpartition(":")[2], 16), int(words[4].rpartition(":")[2], 16) > 0


@click.command()
@click.option("--duration", default=8.0, show_default=True, help="Time that both programs run before their sockets are listed [s].")
def main(duration: float):
    """Run node and player on two machines that are joined by a plant network."""
    python, rows, unread = sys.executable, [], 0
    with tempfile.TemporaryDirectory() as name:
        folder, profile = Path(name), Path(name) / "plant.xml"
        profile.write_text((FOLDER / "fastdds_network.xml").read_text().replace('name="192.0.2.1"', 'name="plant"'))
        log = steady_log(folder / "log.mcap", duration=60.0)
        started = []
        try:
            _build()
            node = _start("first", folder, profile, python, "-m", "bearing_sim.ros.node", "--ros-args", "-p", "overrides:=[level=steady]")
            player = _start("second", folder, profile, python, "-m", "bearing_sim.ros.player", str(log), "--loop")
            listener = _start("second", folder, profile, python, "-c", _LISTENER, stdout=subprocess.PIPE, text=True)
            started += [node, player, listener]
            heard = listener.communicate()[0].strip()
            time.sleep(duration)
            for program, process, machine in (("node", node, "first"), ("player", player, "second")):
                plant, office = _MACHINES[machine]
                found = open_sockets(process.pid)
                counts = [sum(each.address == address for each in found) for address in ("127.0.0.1", plant, office, "0.0.0.0")]
                rows.append((program, *map(str, counts)))
            reachable = [each.port for each in open_sockets(node.pid) if each.address in ("0.0.0.0", _MACHINES["first"][1])]
            subprocess.run(("ip", "netns", "exec", "bearing_second", python, "-c", _SENDER, _MACHINES["first"][1], *map(str, reachable)), check=True)
            time.sleep(1.0)
            unread = sum(port in reachable and waiting for port, waiting in _queues(node.pid))
        finally:
            for process in started:
                process.terminate()
            for process in started:
                process.wait(60.0)
            for machine in _MACHINES:
                subprocess.run(("ip", "netns", "delete", f"bearing_{machine}"), check=False)
    print_rows("Sockets of each program by address", ("program", "loopback", "plant", "office", "any"), rows)
    print(f"outputs of the node heard on the other machine: {heard}")
    print(f"sockets of the node that the office network reaches: {len(reachable)}, of which nothing reads: {unread}")
    sys.exit(not int(heard or 0) or unread != len(reachable))


if __name__ == "__main__":
    main()
