"""ROS domains that nobody on this machine is in, taken and held.

Nodes of one domain find each other. What must meet its own nodes only, as a test, a trial or the
demo does, needs a domain to itself: a number made of that of the process is shared every hundredth
time, and with whatever an earlier one left running.

A domain D has the UDP ports from 7400 + 250 D on (RTPS 9.6.2). Whoever takes it binds the last of
them, which no participant uses, and which the system gives back however the holder ends. It is
free if no other of its ports is bound, whoever its processes belong to and whatever started them.
"""

from __future__ import annotations

import functools
import itertools
import os
import socket
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from geoprim_core.errors import GeoprimError

DOMAINS = range(1, 101)
"""0 is that of everybody; above 101 lie the ports that the system hands out."""

_FIRST_PORT, _PORTS = 7400, 250
_TABLES = (Path("/proc/net/udp"), Path("/proc/net/udp6"))
_turns = itertools.count(os.getpid())  # the next is one that nobody has left a moment ago


@dataclass(frozen=True, slots=True, eq=False)
class Domain:
    """A domain that is held until this is released or dropped, or the process ends.

    Attributes
    ----------
    number : int
        For ROS_DOMAIN_ID.
    lock : socket
        Bound to the last port of the domain.
    """

    number: int
    lock: socket.socket

    def sockets(self) -> dict[int, int]:
        """Return inode -> port of the sockets of those who are in the domain."""
        own = self.lock.getsockname()[1]
        return {inode: port for inode, port in _sockets(self.number).items() if port != own}

    def release(self) -> None:
        """Let others take it."""
        self.lock.close()


def take_domain(numbers: Iterable[int] | None = None) -> Domain:
    """Take a domain that nobody is in.

    Parameters
    ----------
    numbers : whole numbers from 1 to 100, optional
        Which to try, in this order; by default all, from the one after the last that was tried.

    Returns
    -------
    Domain

    Raises
    ------
    GeoprimError
        Somebody is in each of them.

    Examples
    --------
    >>> one, other = take_domain(), take_domain()
    >>> one.number != other.number
    True
    >>> one.release(), other.release()
    (None, None)
    """
    tried = (DOMAINS[next(_turns) % len(DOMAINS)] for _ in DOMAINS) if numbers is None else numbers
    for number in tried:
        domain = _try(number)
        if domain is not None:
            return domain
    raise GeoprimError("no ROS domain is free: end the nodes of some, or set ROS_DOMAIN_ID")


@functools.cache
def private_domain() -> Domain:
    """Return a domain that this process holds until it ends, always the same."""
    return take_domain()


def stay_apart() -> None:
    """Let this process and what it starts keep to this machine, in a domain of their own.

    Variables that are set already are left: ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_DOMAIN_ID.
    """
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    if "ROS_DOMAIN_ID" not in os.environ:
        os.environ["ROS_DOMAIN_ID"] = str(private_domain().number)


def owners(inodes: Iterable[int]) -> dict[int, str]:
    """Return number -> command of the processes that hold sockets, as far as they can be seen."""
    links = {f"socket:[{inode}]" for inode in inodes}
    found: dict[int, str] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            held = any(os.readlink(handle) in links for handle in (folder / "fd").iterdir())
            if held:
                words = (folder / "cmdline").read_bytes().split(b"\0")
                found[int(folder.name)] = b" ".join(words).decode(errors="replace").strip()
        except OSError:
            continue  # it has ended, or is another user's
    return found


def _try(number: int) -> Domain | None:
    """Hold a domain before looking whether somebody is in it, so that two cannot both find it."""
    lock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        lock.bind(("127.0.0.1", _FIRST_PORT + _PORTS * number + _PORTS - 1))
    except OSError:
        lock.close()
        return None
    domain = Domain(number, lock)
    if domain.sockets():
        domain.release()
        return None
    return domain


def _sockets(number: int) -> dict[int, int]:
    first = _FIRST_PORT + _PORTS * number
    found = {}
    for table in _TABLES:
        lines = table.read_text().splitlines()[1:] if table.exists() else []
        for words in map(str.split, lines):
            port = int(words[1].rpartition(":")[2], 16)
            if first <= port < first + _PORTS:
                found[int(words[9])] = port
    return found
