"""Ellipses, one or many, and the outcome of a fit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.types.frozen import Frozen


@dataclass(frozen=True, slots=True)
class Ellipse:
    """One ellipse: centre (x, y) and semi-axes in pixels, angle of the major axis in [0, pi)."""

    x: float
    y: float
    semi_major: float
    semi_minor: float
    angle: float

    def __post_init__(self) -> None:
        values = (self.x, self.y, self.semi_major, self.semi_minor, self.angle)
        if not all(map(math.isfinite, values)):
            raise InputError("ellipse", "finite numbers", str(values))
        if not self.semi_major >= self.semi_minor > 0:
            got = f"{self.semi_major} and {self.semi_minor}"
            raise InputError("semi_major, semi_minor", "semi_major >= semi_minor > 0", got)
        if not 0 <= self.angle < np.pi:
            raise InputError("angle", "an angle in [0, pi)", f"{self.angle}")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Ellipses(Frozen):
    """n ellipses as five arrays (n,): x, y, semi_major, semi_minor in pixels, angle in [0, pi)."""

    x: FloatArray
    y: FloatArray
    semi_major: FloatArray
    semi_minor: FloatArray
    angle: FloatArray

    def __post_init__(self) -> None:
        x = _check.finite(self.x, "x", (None,))
        names = ("y", "semi_major", "semi_minor", "angle")
        rest = {name: _check.finite(getattr(self, name), name, (len(x),)) for name in names}
        self._set(x=x, **rest)
        if not ((self.semi_major >= self.semi_minor) & (self.semi_minor > 0)).all():
            raise InputError("semi_major, semi_minor", "semi_major >= semi_minor > 0", "others")
        if len(x) and not (self.angle.min() >= 0.0 and self.angle.max() < np.pi):
            raise InputError("angle", "angles in [0, pi)", "others")

    def __len__(self) -> int:
        """Return the number of ellipses."""
        return len(self.x)

    def __getitem__(self, index: int) -> Ellipse:
        """Return one ellipse."""
        return Ellipse(*(float(column[index]) for column in self.columns()))

    def __iter__(self) -> Iterator[Ellipse]:
        """Iterate over single ellipses."""
        return (self[i] for i in range(len(self)))

    def columns(self) -> tuple[FloatArray, ...]:
        """Return x, y, semi_major, semi_minor, angle."""
        return self.x, self.y, self.semi_major, self.semi_minor, self.angle

    def array(self) -> FloatArray:
        """Return the ellipses as an (n, 5) array of x, y, semi_major, semi_minor, angle."""
        return np.stack(self.columns(), axis=1)

    def select(self, chosen: Any) -> Ellipses:
        """Return the ellipses at the given indices or where the mask is true."""
        return Ellipses(*(column[chosen] for column in self.columns()))

    @classmethod
    def from_array(cls, values: Any) -> Ellipses:
        """Build from an (n, 5) array of x, y, semi_major, semi_minor, angle."""
        return cls(*_check.numbers(values, "values", (None, 5)).T.copy())


@dataclass(frozen=True, slots=True, eq=False)
class EllipseFit:
    """The outcome of an ellipse fit: an ellipse, or None and the reason why there is none.

    Attributes
    ----------
    ellipse : Ellipse or None
    reason : str
        Empty when there is an ellipse.
    conic : (6,) float64 or None
        a, b, c, d, f, g of a x^2 + b x y + c y^2 + d x + f y + g = 0, thesis (4-1).
    residual : float
        Root mean square of the minimised algebraic residual; NaN without a conic.
    """

    ellipse: Ellipse | None
    reason: str = ""
    conic: FloatArray | None = None
    residual: float = float("nan")
