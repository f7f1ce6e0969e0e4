# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keep the programs' topics on this machine: no socket of the middleware beyond the loopback interface, unless the user has chosen otherwise.

``ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`` decides with whom ROS speaks, not where it listens: rmw_fastrtps then still receives on all interfaces.
A profile of Fast DDS restricts what listens to 127.0.0.1.  At LOCALHOST rmw_fastrtps also adds a transport of its own, which opens sockets for
sending on all interfaces; they are replaced by sockets on 127.0.0.1 once the node exists.

``python -m bearing_sim.ros.network`` prints the folder of the profiles and of the policy for SROS 2.
"""

import os
import socket
from collections.abc import Iterator, Mapping
from pathlib import Path

from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier

FOLDER = Path(__file__).with_name("dds")
LOOPBACK_PROFILE = FOLDER / "fastdds_loopback.xml"
_RANGE, _LOCALHOST_ONLY = "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"
_PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")  # of Fast DDS 2 (Jazzy) and 3 (Kilted)
_OTHER_CHOICES = ("ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER")
_OWN_FILES = ("DEFAULT_FASTRTPS_PROFILES.xml", "DEFAULT_FASTDDS_PROFILES.xml")  # read by Fast DDS 2 and 3 from the working directory
_LOOPBACK = "127.0.0.1"


def loopback_variables(environment: Mapping[str, str], folder: Path) -> dict[str, str]:
    """Return the environment variables to set so that topics stay on this machine; none where the user has chosen how ROS uses the network.

    Parameters
    ----------
    environment : in which the program was started.
    folder : the working directory, where Fast DDS looks for a profile too.
    """
    discovery, localhost_only = environment.get(_RANGE, ""), environment.get(_LOCALHOST_ONLY, "")
    profiles = [environment[name] for name in _PROFILES if environment.get(name)]
    if any(path != str(LOOPBACK_PROFILE) for path in profiles) or any((folder / name).exists() for name in _OWN_FILES):
        return {}
    if any(environment.get(name) for name in _OTHER_CHOICES):
        return {}
    if localhost_only != "1" and (discovery or ("LOCALHOST" if not localhost_only else "")) != "LOCALHOST":
        return {}
    variables = dict.fromkeys(_PROFILES, str(LOOPBACK_PROFILE))
    return variables if discovery or localhost_only else variables | {_RANGE: "LOCALHOST"}


def use_loopback() -> str:
    """Keep the topics of this process on this machine; to be called before ROS is initialised.

    Returns
    -------
    What to tell the user, because it is not what other ROS programs do; empty if there is nothing to tell.
    """
    variables = loopback_variables(os.environ, Path.cwd())
    os.environ.update(variables)
    return f"{_RANGE} is not set: topics are visible on this machine only; set it to SUBNET for the network" if _RANGE in variables else ""


def close_other_interfaces(node: Node) -> None:
    """Replace the sending sockets of Fast DDS beyond 127.0.0.1, where `use_loopback` applies; warn of what still is reachable.

    To be called once the node exists: its participant opens all of its sockets then.
    """
    if os.environ.get(_PROFILES[0]) != str(LOOPBACK_PROFILE) or not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return
    bound = list(_datagram_sockets())
    if any(address == _LOOPBACK for _, address, _ in bound):  # otherwise the profile has had no effect, and those that remain receive
        for descriptor, address, _ in bound:
            if address != _LOOPBACK:
                _replace(descriptor)
    reachable = [f"{address}:{port}" for _, address, port in _datagram_sockets() if address != _LOOPBACK]
    if reachable:
        node.get_logger().warning(
            f"the middleware has sockets beyond {_LOOPBACK}: {', '.join(reachable)}; the profile {LOOPBACK_PROFILE} has no effect"
        )


def _datagram_sockets() -> Iterator[tuple[int, str, int]]:
    """Yield descriptor, address and port of all bound IPv4 datagram sockets of this process (Linux; none elsewhere)."""
    try:
        descriptors = sorted(map(int, os.listdir("/proc/self/fd")))
    except OSError:
        return
    for descriptor in descriptors:
        try:
            with socket.socket(fileno=os.dup(descriptor)) as copy:
                if copy.family == socket.AF_INET and copy.type == socket.SOCK_DGRAM and copy.getsockname()[1]:
                    yield descriptor, *copy.getsockname()
        except OSError:  # no socket, or closed in the meantime
            continue


def _replace(descriptor: int) -> None:
    """Put a socket on 127.0.0.1 in place of one that only sends; the middleware keeps using the descriptor."""
    with socket.socket(fileno=os.dup(descriptor)) as old, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as new:
        new.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, old.getsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF) // 2)  # the kernel tells the double
        for option in (socket.IP_MULTICAST_TTL, socket.IP_MULTICAST_LOOP):
            new.setsockopt(socket.IPPROTO_IP, option, old.getsockopt(socket.IPPROTO_IP, option))
        new.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(_LOOPBACK))
        new.setblocking(os.get_blocking(descriptor))
        new.bind((_LOOPBACK, 0))
        os.dup2(new.fileno(), descriptor, inheritable=False)


if __name__ == "__main__":
    print(FOLDER)
