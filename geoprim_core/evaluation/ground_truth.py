"""The true ellipses of an image, and the files that hold them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geoprim_core._check import BoolArray
from geoprim_core.errors import FileError, InputError
from geoprim_core.types import Ellipses

_USES = ("full", "recall-only")


@dataclass(frozen=True, slots=True, eq=False)
class GroundTruth:
    """The true ellipses of one image.

    Attributes
    ----------
    name : str
        Name of the image.
    ellipses : Ellipses, m of them
    uncertain : (m,) bool or None
        Ellipses that count neither as hit nor as miss; None: there are none.
    recall_only : bool
        True where further ellipses may be in the image: unmatched detections do not count.
    path : Path or None
        The image file.
    group : str
        The sequence or collection that the image belongs to.
    """

    name: str
    ellipses: Ellipses
    uncertain: BoolArray | None = None
    recall_only: bool = False
    path: Path | None = None
    group: str = ""

    def __post_init__(self) -> None:
        count = len(self.ellipses)
        flags = np.zeros(count, bool) if self.uncertain is None else np.asarray(self.uncertain)
        if flags.shape != (count,) or flags.dtype != np.bool_:
            raise InputError("uncertain", f"{count} flags, one an ellipse", f"{flags.shape}")
        object.__setattr__(self, "uncertain", flags)


def load_ground_truth(
    folder: str | Path, images: str | Path | None = None
) -> tuple[GroundTruth, ...]:
    """Read the ground-truth files (`*.json`) of a folder and its subfolder `gt`, by name.

    A file holds an object with `image` (path of the image), `ellipses` (a list of `xc`, `yc`,
    `a`, `b` in pixels, `theta_deg` from +x towards +y, and optionally `uncertain`) and optionally
    `use`: "full" (all ellipses of the image are listed) or "recall-only".

    Parameters
    ----------
    folder : path
        JSON files of another kind are passed over.
    images : path or None
        Folder that the image paths start from. None: the folder itself or its parent, where the
        image is.

    Returns
    -------
    tuple of GroundTruth

    Raises
    ------
    FileError
        There are no such files, or one does not hold what it should; the message names it.

    Examples
    --------
    >>> import tempfile
    >>> ellipse = '{"xc": 9, "yc": 8, "a": 5, "b": 4, "theta_deg": -90}'
    >>> text = f'{{"image": "a.png", "ellipses": [{ellipse}]}}'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "a.json").write_text(text)
    ...     truth = load_ground_truth(folder)
    >>> truth[0].name, truth[0].ellipses.angle.round(3).tolist()
    ('a.png', [1.571])
    """
    base = Path(folder)
    for place in (base, *([Path(images)] if images is not None else [])):
        if not place.is_dir():
            raise FileError(
                f"{place}: expected a folder, got {'a file' if place.exists() else 'none'}"
            )
    files = [*sorted(base.glob("*.json")), *sorted(base.glob("gt/*.json"))]
    read = [_parse(file, images) for file in files]
    truth = tuple(entry for entry in read if entry is not None)
    if not truth:
        raise FileError(f"{base}: no ground-truth files (*.json with 'image' and 'ellipses')")
    return truth


def _parse(file: Path, images: str | Path | None) -> GroundTruth | None:
    """Read one file; None for a JSON file of another kind."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FileError(f"{file}: not readable as JSON ({error})") from error
    if not (isinstance(content, dict) and "image" in content and "ellipses" in content):
        return None
    try:
        return _ground_truth(content, file, images)
    except (KeyError, TypeError, ValueError) as error:
        raise FileError(f"{file}: wrong ground truth ({error})") from error


def _ground_truth(content: dict[str, Any], file: Path, images: str | Path | None) -> GroundTruth:
    name = str(content["image"])
    use = content.get("use", "full")
    if use not in _USES:
        raise InputError("use", "one of " + ", ".join(_USES), repr(use))
    entries = content["ellipses"]
    rows = [_ellipse_row(entry) for entry in entries]
    uncertain = np.array([bool(entry.get("uncertain", False)) for entry in entries], bool)
    group = Path(name).parent.as_posix()
    return GroundTruth(
        name,
        Ellipses.from_array(rows),
        uncertain,
        use == "recall-only",
        _image_path(name, file, images),
        "" if group == "." else group,
    )


def _ellipse_row(entry: dict[str, Any]) -> list[float]:
    a, b, angle = float(entry["a"]), float(entry["b"]), np.deg2rad(float(entry["theta_deg"]))
    if a < b:
        a, b, angle = b, a, angle + np.pi / 2
    turn = float(angle % np.pi)
    return [float(entry["xc"]), float(entry["yc"]), a, b, turn if turn < np.pi else 0.0]


def _image_path(name: str, file: Path, images: str | Path | None) -> Path:
    bases = [Path(images)] if images is not None else [file.parent, file.parent.parent]
    found = [base / name for base in bases if (base / name).is_file()]
    return found[0] if found else bases[0] / name
