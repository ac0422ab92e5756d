"""Configuration files: ROS 2 parameter files, read the same way with and without ROS.

The form is that of `ros2 run ... --ros-args --params-file FILE`:

    /**:
      ros__parameters:
        plane_distance: 0.6
        labels: [cent]
        cent: {unit: mm, min_length: 15.0, max_length: 17.0}
        edges: {sigma: 1.0}
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from geoprim_core._check import describe
from geoprim_core.applications.sorting import OTHER, PLANE_DISTANCE, ClassParams, SortingParams
from geoprim_core.ecc import DetectorParams
from geoprim_core.errors import FileError, ParameterError
from geoprim_core.io.shown import OverlayParams, ViewParams

# Parameters of the nodes that mean nothing offline.
_ROS_ONLY = (
    "use_sim_time", "image_transport", "qos_overrides", "start_type_description_service",
    "markers",
)  # fmt: skip


class Config(NamedTuple):
    """The parameters of the whole chain.

    Attributes
    ----------
    detector : DetectorParams
    sorting : SortingParams
    plane_distance : float
        Distance of the working plane in metres; 0 where it is not known.
    overlay : OverlayParams
    """

    detector: DetectorParams
    sorting: SortingParams
    plane_distance: float = 0.0
    overlay: OverlayParams = OverlayParams()


def load_config(path: str | os.PathLike[str]) -> Config:
    """Read a ROS 2 parameter file.

    Parameters
    ----------
    path : path of the YAML file
        The sections of all nodes are taken together. Parameters that only nodes have, such as
        `use_sim_time`, are passed over.

    Returns
    -------
    Config

    Raises
    ------
    FileError
        The file is missing or is not a parameter file.
    ParameterError
        A key is unknown or a value is refused; the text names the file and the key.
    """
    values = dict(_flat(_parameters(Path(path))))
    values = {k: v for k, v in values.items() if k.partition(".")[0] not in _ROS_ONLY}
    try:
        return _config(values)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error.argument}", error.expected, error.got) from None


def _config(values: dict[str, Any]) -> Config:
    chain = {option.name for option in DetectorParams.options()}
    shown = {option.name for option in ViewParams.options()}
    classes = {option.name for option in ClassParams.options()}
    labels = values.get("labels", list(SortingParams().classes))
    names = [str(label) for label in labels] if isinstance(labels, list) else []
    taken = {name.partition(".")[0] for name in chain | shown} | {
        "labels",
        OTHER.name,
        PLANE_DISTANCE.name,
    }
    for name in names:
        if name in taken:
            raise ParameterError("labels", "names that are not parameters themselves", repr(name))
    sorting = {"labels", OTHER.name} | {f"{name}.{field}" for name in names for field in classes}
    known = chain | shown | sorting | {PLANE_DISTANCE.name}
    for name in values:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            hint = f" (did you mean {near[0]!r}?)" if near else ""
            raise ParameterError(name, f"the name of a parameter{hint}", "an unknown one")
    distance = PLANE_DISTANCE.checked(values.get(PLANE_DISTANCE.name, PLANE_DISTANCE.default))
    return Config(
        DetectorParams.from_dict({k: v for k, v in values.items() if k in chain}),
        SortingParams.from_dict({k: v for k, v in values.items() if k in sorting}),
        float(distance),
        ViewParams.from_dict({k: v for k, v in values.items() if k in shown}).overlay,
    )


def _parameters(path: Path) -> dict[str, Any]:
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        text = " ".join(str(error).split())
        raise FileError(f"{path} is not a YAML file: {text}") from None
    form = "a ROS 2 parameter file: '/**:', below it 'ros__parameters:', below it the parameters"
    if not isinstance(document, dict) or not document:
        raise FileError(f"{path}: expected {form}, got {describe(document)}")
    merged: dict[str, Any] = {}
    for node, section in document.items():
        if not isinstance(section, dict) or list(section) != ["ros__parameters"]:
            raise FileError(f"{path}: {node}: expected {form}, got {describe(section)}")
        merged.update(section["ros__parameters"] or {})
    return merged


def _flat(values: Mapping[Any, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
