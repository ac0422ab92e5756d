"""Sorting: ellipses become labelled objects by size, shape and evidence (thesis 6.1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Self

import numpy as np

from geoprim_core._check import AnyArray, BoolArray, FloatArray, describe
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.fitting import ellipse_boxes
from geoprim_core.params import Option, Params, option
from geoprim_core.types import Camera, Detections, EllipseDetections, Ellipses

OUTLINE_VERTICES = 48

PLANE_DISTANCE = Option(
    "plane_distance",
    0.0,
    "distance of the working plane from the camera along its axis; 0 where it is not known",
    unit="m",
    low=0.0,
    high=1000.0,
)
OTHER = Option("other", "", "label of objects that fit no class; empty: they are not reported")


@dataclass(frozen=True)
class ClassParams(Params):
    """What an ellipse has to be to belong to one class."""

    unit: str = option("px", "unit of lengths and widths", choices=("px", "mm"))
    min_length: float = option(0.0, "least major axis, in `unit`", low=0.0, high=1e6)
    max_length: float = option(1e6, "largest major axis, in `unit`", low=0.0, high=1e6)
    min_width: float = option(0.0, "least minor axis, in `unit`", low=0.0, high=1e6)
    max_width: float = option(1e6, "largest minor axis, in `unit`", low=0.0, high=1e6)
    min_axis_ratio: float = option(0.0, "least minor axis / major axis", low=0.0, high=1.0)
    max_axis_ratio: float = option(1.0, "largest minor axis / major axis", low=0.0, high=1.0)
    min_coverage: float = option(
        0.0, "least share of the outline with edge support", low=0.0, high=1.0
    )
    min_score: float = option(0.0, "least score", low=0.0, high=1.0)

    def __post_init__(self) -> None:
        """Check every field, and that no least value exceeds the largest."""
        super().__post_init__()
        for name in ("length", "width", "axis_ratio"):
            low, high = getattr(self, f"min_{name}"), getattr(self, f"max_{name}")
            if low > high:
                raise ParameterError(f"min_{name}", f"at most max_{name} = {high}", f"{low}")


def _everything() -> Mapping[str, ClassParams]:
    return {"ellipse": ClassParams()}


@dataclass(frozen=True)
class SortingParams:
    """The classes of a sorting task in the order in which they are tried.

    Attributes
    ----------
    classes : mapping of label -> ClassParams
        By default a single class "ellipse" that everything fits.
    other : str
        Label of objects that fit no class; empty: they are not reported.

    Raises
    ------
    ParameterError
        A label is not a name, or a class is not a ClassParams.

    Examples
    --------
    >>> sorting = SortingParams.from_dict({"labels": ["cent"], "cent": {"max_length": 40.0}})
    >>> sorting.classes["cent"].max_length
    40.0
    """

    classes: Mapping[str, ClassParams] = field(default_factory=_everything)
    other: str = ""

    def __post_init__(self) -> None:
        for label, params in self.classes.items():
            if not isinstance(label, str) or not label.isidentifier():
                expected = "names of letters, digits and underscores"
                raise ParameterError("labels", expected, describe(label))
            if not isinstance(params, ClassParams):
                raise ParameterError(label, "a ClassParams", describe(params))
        object.__setattr__(self, "other", OTHER.checked(self.other))
        object.__setattr__(self, "classes", MappingProxyType(dict(self.classes)))

    @property
    def needs_camera(self) -> bool:
        """Whether a class is given in millimetres."""
        return any(params.unit == "mm" for params in self.classes.values())

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Build from `labels`, `other` and one nested mapping or dotted names a label.

        Without `labels` the default class remains.

        Raises
        ------
        ParameterError
            A name is unknown or a value is refused; the text has the full name.
        """
        rest = dict(values)
        other = rest.pop("other", "")
        labels = rest.pop("labels", None)
        if labels is not None and not isinstance(labels, list | tuple):
            raise ParameterError("labels", "a list of names", describe(labels))
        names = list(_everything()) if labels is None else list(labels)
        if len(set(map(str, names))) < len(names):
            raise ParameterError("labels", "names that differ", describe(labels))
        classes = {name: _class_params(str(name), rest) for name in names}
        for name in rest:
            if name.partition(".")[0] not in classes:
                expected = "labels, other or one of the labels: " + ", ".join(map(str, names))
                raise ParameterError(name, expected, repr(name))
        return cls(classes, other)

    def to_dict(self) -> dict[str, Any]:
        """Return labels, other and all class parameters under their dotted names."""
        values: dict[str, Any] = {"labels": list(self.classes), "other": self.other}
        for label, params in self.classes.items():
            values.update({f"{label}.{name}": v for name, v in params.to_dict().items()})
        return values


def classify(
    found: EllipseDetections, sorting: SortingParams | None = None, camera: Camera | None = None
) -> Detections:
    """Give every ellipse the label of the first class that it fits.

    Parameters
    ----------
    found : EllipseDetections
    sorting : SortingParams, optional
        By default every ellipse is an "ellipse".
    camera : Camera, optional
        Gives sizes in metres; needed as soon as a class is in millimetres.

    Returns
    -------
    Detections
        In the order of `found`, without those that fit no class unless `sorting.other` names
        them. Boxes and outline polygons (`OUTLINE_VERTICES` vertices, float32 numbers) are those
        of the whole ellipse, also where it leaves the image.

    Raises
    ------
    InputError
        A class is in millimetres and there is no camera.

    References
    ----------
    Thesis 6.1: ellipses as objects for robotics and machine vision.

    Examples
    --------
    >>> none = np.zeros(1)
    >>> disc = Ellipses.from_array([[50, 40, 20, 20, 0]])
    >>> found = EllipseDetections(disc, none + 1, none, none, none, np.zeros((1, 5, 5)))
    >>> lid = SortingParams({"lid": ClassParams(unit="mm", min_length=30.0, max_length=50.0)})
    >>> objects = classify(found, lid, Camera(fx=500, fy=500, cx=50, cy=40, distance=0.5))
    >>> objects.labels, objects.size.tolist()
    (('lid',), [[0.04, 0.04]])
    """
    sorting = sorting or SortingParams()
    if sorting.needs_camera and camera is None:
        label = next(name for name, params in sorting.classes.items() if params.unit == "mm")
        raise InputError("camera", f"a Camera, because class {label!r} is in mm", "None")
    pixels = 2 * np.stack([found.ellipses.semi_major, found.ellipses.semi_minor], axis=1)
    unknown = np.full((len(found), 2), np.nan)
    metres = unknown if camera is None else size_on_plane(found.ellipses, camera)
    labels = np.full(len(found), sorting.other, dtype=object)
    for label, params in reversed(list(sorting.classes.items())):
        labels[_fits(found, params, pixels if params.unit == "px" else 1000 * metres)] = label
    return _detections(found, labels, metres)


def size_on_plane(ellipses: Ellipses, camera: Camera) -> FloatArray:
    """Return length and width (n, 2) in metres of ellipses that lie on the working plane.

    A plane square to the axis at distance Z shows a length L along x as L fx / Z pixels. Where
    fx and fy differ the axes of the ellipse turn; the result belongs to the turned axes.

    Examples
    --------
    >>> camera = Camera(fx=800, fy=800, cx=320, cy=240, distance=0.4)
    >>> size_on_plane(Ellipses.from_array([[320, 240, 60, 30, 1.0]]), camera).round(9).tolist()
    [[0.06, 0.03]]
    """
    axes = np.stack([ellipses.semi_major, ellipses.semi_minor], axis=1)
    if camera.fx == camera.fy:
        return axes * (2 * camera.distance / camera.fx)
    cos, sin = np.cos(ellipses.angle), np.sin(ellipses.angle)
    turn = np.stack([cos, -sin, sin, cos], axis=1).reshape(-1, 2, 2)
    scale = camera.distance / np.array([camera.fx, camera.fy])
    # The singular values of the map from the unit circle to the ellipse are its semi-axes.
    size: FloatArray = 2 * np.linalg.svd(scale[:, None] * turn * axes[:, None, :], compute_uv=False)
    return size


def ellipse_outlines(ellipses: Ellipses, count: int) -> FloatArray:
    """Return `count` points on each ellipse as (n, count, 2), all of them float32 numbers.

    Examples
    --------
    >>> ellipse_outlines(Ellipses.from_array([[5, 5, 2, 1, 0]]), 4).round(6).tolist()
    [[[7.0, 5.0], [5.0, 6.0], [3.0, 5.0], [5.0, 4.0]]]
    """
    t = np.arange(count) * (2 * np.pi / count)
    u, v = np.outer(ellipses.semi_major, np.cos(t)), np.outer(ellipses.semi_minor, np.sin(t))
    cos, sin = np.cos(ellipses.angle)[:, None], np.sin(ellipses.angle)[:, None]
    x = ellipses.x[:, None] + u * cos - v * sin
    y = ellipses.y[:, None] + u * sin + v * cos
    outlines: FloatArray = np.stack([x, y], axis=2).astype(np.float32).astype(np.float64)
    return outlines


def _class_params(label: str, values: Mapping[str, Any]) -> ClassParams:
    dotted = {
        k.removeprefix(f"{label}."): v for k, v in values.items() if k.startswith(f"{label}.")
    }
    nested = values.get(label, {})
    if not isinstance(nested, Mapping):
        raise ParameterError(label, "the parameters of the class", describe(nested))
    try:
        return ClassParams.from_dict({**nested, **dotted})
    except ParameterError as error:
        raise ParameterError(f"{label}.{error.argument}", error.expected, error.got) from None


def _fits(found: EllipseDetections, params: ClassParams, size: FloatArray) -> BoolArray:
    length, width = size.T
    with np.errstate(invalid="ignore"):
        ratio = width / length
    fits: BoolArray = (
        (length >= params.min_length)
        & (length <= params.max_length)
        & (width >= params.min_width)
        & (width <= params.max_width)
        & (ratio >= params.min_axis_ratio)
        & (ratio <= params.max_axis_ratio)
        & (found.coverage >= params.min_coverage)
        & (found.score >= params.min_score)
    )
    return fits


def _detections(found: EllipseDetections, labels: AnyArray, metres: FloatArray) -> Detections:
    chosen = labels != ""
    ellipses = found.ellipses.select(chosen)
    count = len(ellipses)
    return Detections(
        labels=tuple(labels[chosen]),
        score=found.score[chosen],
        boxes=ellipse_boxes(ellipses),
        ellipses=ellipses,
        polygons=ellipse_outlines(ellipses, OUTLINE_VERTICES).reshape(-1, 2),
        polygon_offsets=np.arange(count + 1) * OUTLINE_VERTICES,
        size=metres[chosen],
        image_size=found.image_size,
    )
