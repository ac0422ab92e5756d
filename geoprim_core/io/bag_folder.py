"""The files of a rosbag2 folder, held against its metadata.yaml."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from geoprim_core.errors import BagError
from geoprim_core.io.losses import Loss
from geoprim_core.io.mcap_file import McapFile

_METADATA = "metadata.yaml"
_LARGEST_METADATA = 1 << 24


@dataclass
class BagFiles:
    """The files of a bag, and what is wrong with the set of them.

    Attributes
    ----------
    files : list of McapFile
        In the order of their numbers.
    losses : list of Loss
        Files that are missing or cannot be read at all.
    notes : list of str
    uncounted : bool
        A file is lost and nothing tells how many messages it had.
    """

    files: list[McapFile] = field(default_factory=list)
    losses: list[Loss] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    uncounted: bool = False


def open_files(path: Path, *, keep_doubtful: bool) -> BagFiles:
    """Open the file, or the files of a folder, that can be read.

    Raises
    ------
    BagError
        None can.
    """
    if not path.is_dir():
        return BagFiles([McapFile(path, keep_doubtful=keep_doubtful)])
    names = sorted(path.glob("*.mcap"), key=_natural)
    if not names:
        held = ", ".join(sorted(p.name for p in path.iterdir())[:8]) or "nothing"
        packed = "; unpack them with `zstd -d` first" if any(path.glob("*.mcap.zstd")) else ""
        raise BagError(f"folder {path} holds no .mcap file; it holds {held}{packed}")
    bag = BagFiles()
    listed = _listed(path, bag)
    errors = [_open_file(name, listed, keep_doubtful, bag) for name in names]
    if not bag.files:
        raise BagError("; ".join(error for error in errors if error))
    for name in sorted(set(listed) - {file.name for file in names}):
        _lose(bag, f"file {name}, which {_METADATA} lists, is missing", 0, listed[name])
    _note_gaps(names, listed, bag)
    return bag


def _open_file(
    name: Path, listed: dict[str, dict[str, Any]], keep_doubtful: bool, bag: BagFiles
) -> str:
    """Add a file to the bag or its loss; return why it cannot be read."""
    facts = listed.get(name.name, {})
    try:
        file = McapFile(name, keep_doubtful=keep_doubtful)
    except BagError as error:
        _lose(bag, str(error), name.stat().st_size, facts)
        return str(error)
    file.announced = _whole(facts.get("message_count"))
    bag.files.append(file)
    return ""


def _lose(bag: BagFiles, reason: str, length: int, facts: dict[str, Any]) -> None:
    count = _whole(facts.get("message_count"))
    loss = Loss(0, length, reason, count or 0)
    start = _whole(_part(facts, "starting_time", "nanoseconds_since_epoch"))
    duration = _whole(_part(facts, "duration", "nanoseconds"))
    if start is not None and duration is not None:
        loss.span(start, start + duration)
    bag.uncounted |= count is None
    bag.losses.append(loss)


def _listed(path: Path, bag: BagFiles) -> dict[str, dict[str, Any]]:
    """Return the files that the metadata lists, with what it says of each."""
    file = path / _METADATA
    try:
        with file.open("rb") as opened:
            content = yaml.safe_load(opened.read(_LARGEST_METADATA))
        facts = content["rosbag2_bagfile_information"]
        names = [Path(str(name)).name for name in facts["relative_file_paths"]]
        if str(facts.get("compression_mode")).lower() == "message":
            bag.notes.append("each message is compressed; unpack them with `ros2 bag convert`")
        details = {Path(str(f["path"])).name: dict(f) for f in facts.get("files") or ()}
    except FileNotFoundError:
        bag.notes.append(f"{_METADATA} is missing; whether a file at the end is cannot be told")
        return {}
    except Exception as error:  # whatever YAML or a wrong structure comes up with
        first = str(error).splitlines()[0] if str(error) else ""
        bag.losses.append(Loss(0, 0, f"{_METADATA} is damaged ({type(error).__name__}: {first})"))
        return {}
    return {name: details.get(name, {}) for name in names}


def _note_gaps(names: list[Path], listed: dict[str, Any], bag: BagFiles) -> None:
    """Without metadata: note the files that the numbers of the others tell are missing."""
    numbers = [re.fullmatch(r"(.*_)(\d+)", name.stem) for name in names]
    if listed or not all(numbers) or len({n[1] for n in numbers if n}) != 1:
        return
    found = {int(n[2]) for n in numbers if n}
    for number in sorted(set(range(max(found))) - found)[:100]:
        reason = f"file {numbers[0][1] if numbers[0] else ''}{number}.mcap is missing"
        bag.losses.append(Loss(0, 0, reason))
        bag.uncounted = True


def _part(facts: dict[str, Any], name: str, key: str) -> Any:
    value = facts.get(name)
    return value.get(key) if isinstance(value, dict) else None


def _whole(value: Any) -> int | None:
    return value if type(value) is int and 0 <= value < 1 << 63 else None


def _natural(path: Path) -> list[str]:
    """Return a sorting key by which bag_10 comes after bag_9."""
    return [part.zfill(12) for part in re.split(r"(\d+)", path.name)]
