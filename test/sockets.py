# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The internet sockets of processes, as the kernel lists them (Linux)."""

import ipaddress
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from measure import processes_of

_TABLES = ("udp", "udp6", "udplite", "udplite6", "tcp", "tcp6", "raw", "raw6")
_LISTENING, _UNCONNECTED = "0A", "07"  # states of TCP and UDP sockets in /proc/net (include/net/tcp_states.h of Linux)


class Socket(NamedTuple):
    """A socket that others can reach."""

    kind: str  # such as udp or tcp6
    address: str
    port: int

    @property
    def is_on_loopback(self) -> bool:
        """Whether only processes of this machine can reach it."""
        return ipaddress.ip_address(self.address).is_loopback


def open_sockets(pid: int) -> list[Socket]:
    """Return the sockets of a process and its descendants that receive: listening TCP sockets and all bound datagram sockets."""
    return sorted({each for process in processes_of(pid) for each in _of_process(process)})


def _of_process(pid: int) -> Iterator[Socket]:
    inodes = set(_socket_inodes(Path(f"/proc/{pid}/fd")))
    for kind in _TABLES:
        try:
            table = Path(f"/proc/{pid}/net/{kind}").read_text()
        except OSError:  # the process has ended, or the kernel knows no such sockets
            continue
        for line in table.splitlines()[1:]:
            words = line.split()
            if words[9] in inodes and words[3] in (_LISTENING, _UNCONNECTED):
                address, _, port = words[1].partition(":")
                yield Socket(kind, _address(address), int(port, 16))


def _socket_inodes(descriptors: Path) -> Iterator[str]:
    try:
        names = os.listdir(descriptors)
    except OSError:  # the process has ended
        return
    for name in names:
        try:
            target = os.readlink(descriptors / name)
        except OSError:  # closed in the meantime
            continue
        if target.startswith("socket:["):
            yield target[len("socket:[") : -1]


def _address(text: str) -> str:
    """Return an address from its words of 32 bits, each in the byte order of the machine, x86 and ARM alike."""
    octets = b"".join(bytes.fromhex(text[first : first + 8])[::-1] for first in range(0, len(text), 8))
    return str(ipaddress.ip_address(octets))
