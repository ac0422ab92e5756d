"""What processes that were killed leave in /dev/shm, and taking it away.

Every participant of Fast DDS has a segment of shared memory, 17 MB with our profile, beside a file
that it locks as long as it lives. After `kill -9` the system lets go of the lock, but the files
stay. A process that had read from the dead one takes them away within seconds; where all have
ended, they fill the memory until the machine starts anew.

    python -m geoprim_ros.shared_memory

takes away what no process holds, as every start of a node does with the segments.
"""

from __future__ import annotations

import argparse
import fcntl
import os
import re
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path("/dev/shm")
_SEGMENT = re.compile(r"fastrtps_[0-9a-z]{16}")
_PORT = re.compile(r"fastrtps_port\d{1,5}")
_LOCKS = ("_el", "_sl")
# A process that starts makes its files first and locks them then.
_SETTLED_S = 10.0


@dataclass(frozen=True)
class Leftovers:
    """What dead processes left: names of files, and how much memory they take.

    Attributes
    ----------
    names : the files
    bytes : their size together
    """

    names: tuple[str, ...] = ()
    bytes: int = 0

    def __str__(self) -> str:
        return f"{len(self.names)} files, {self.bytes / 1e6:.1f} MB"


def clean(
    folder: Path = FOLDER, *, ports: bool = False, settled_s: float = _SETTLED_S, dry: bool = False
) -> Leftovers:
    """Remove the files of shared memory that belong to this user and that no process holds.

    The name of a segment is never used again, so that one without an owner stays without. The
    name of a port is, by the next process on its domain: nodes may be starting with it.

    Parameters
    ----------
    folder : where they are
    ports : remove ports too, for a moment in which no node starts
    settled_s : files that are younger than so many seconds stay
    dry : remove nothing

    Returns
    -------
    Leftovers
        What was removed, or would be.
    """
    removed: list[str] = []
    size = 0
    in_use = _mapped(folder) if ports else set()
    for name in _names(folder, ports):
        held = _hold(folder, name, settled_s)
        if held is None:
            continue
        # A port without a lock is what a killed writer leaves.
        if name not in in_use and (held or _PORT.fullmatch(name)):
            for path in _present(folder, name):
                with suppress(OSError):  # another process takes it away in the same moment
                    size += path.stat().st_size
                    if not dry:
                        path.unlink()
                    removed.append(path.name)
        for descriptor in held:
            os.close(descriptor)
    return Leftovers(tuple(removed), size)


def segments(folder: Path = FOLDER) -> list[str]:
    """Return the names of the segments that are there, with an owner or without."""
    return [name for name in _listed(folder) if _SEGMENT.fullmatch(name)]


def unowned(folder: Path = FOLDER) -> set[str]:
    """Return the names of this user's segments that no process holds."""
    return set(clean(folder, settled_s=0.0, dry=True).names) & set(segments(folder))


def _listed(folder: Path) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:  # other systems keep shared memory elsewhere
        return []


def _names(folder: Path, ports: bool) -> list[str]:
    """Return the segments and ports of which something is left, their lock at least."""
    names = {name[:-3] if name.endswith(_LOCKS) else name for name in _listed(folder)}
    kinds = (_SEGMENT, _PORT) if ports else (_SEGMENT,)
    return sorted(name for name in names if any(kind.fullmatch(name) for kind in kinds))


def _present(folder: Path, name: str) -> list[Path]:
    """Return what there is of a segment or port, the locks last."""
    names = (name, f"sem.{name}_mutex", *(name + lock for lock in _LOCKS))
    return [path for path in (folder / n for n in names) if path.exists()]


def _hold(folder: Path, name: str, settled_s: float) -> list[int] | None:
    """Take the locks of something of this user; return None where a process holds one."""
    held: list[int] = []
    try:
        for path in _present(folder, name):
            status = path.stat()
            if status.st_uid != os.getuid() or time.time() - status.st_ctime < settled_s:
                raise PermissionError(path)
            if path.name.endswith(_LOCKS):
                held.append(os.open(path, os.O_RDONLY | os.O_CLOEXEC))
                fcntl.flock(held[-1], fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        for descriptor in held:
            os.close(descriptor)
        return None
    return held


def _mapped(folder: Path) -> set[str]:
    """Return the files of a folder that some process has in its memory."""
    start, names = f"{folder}/", set()
    for maps in Path("/proc").glob("[0-9]*/maps"):
        with suppress(OSError):  # it has ended, or is another user's, as its files are
            lines = maps.read_text(errors="replace").splitlines()
            names |= {line.rpartition("/")[2] for line in lines if start in line}
    return names


def main() -> int:
    """Take away what no process holds, and tell how much it was."""
    parser = argparse.ArgumentParser(prog="geoprim_ros.shared_memory", description=__doc__)
    parser.add_argument("--dry-run", action="store_true", help="tell it only")
    options = parser.parse_args()
    before = len(segments())
    found = clean(ports=True, dry=options.dry_run)
    left = before if options.dry_run else len(segments())
    print(f"{'found' if options.dry_run else 'removed'}: {found}; {left} segments are there")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
