"""Precision against reliability of fitted lines, worked out: thesis 2.2.2 and Appendix A.

The thesis shows that the error of the least squares line over M pixels is governed by M - sum B,
B = X (X'X)^-1 X', and that sum B <= M (2-8); it concludes that few pixels are fitted precisely
and many reliably. Here the sums are computed and both metrics are measured on lines over pieces
of curves that grow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.evaluation.claims import Claim
from geoprim_core.polygon import farthest_pair

LENGTHS = (10, 20, 40, 80)
"""Pixels of the pieces over which lines are fitted."""


@dataclass(frozen=True, slots=True)
class LineFit:
    """A line fitted to the pixels of a piece of a curve.

    Attributes
    ----------
    pixels : int
        M.
    share : float
        sum B / M of (2-8); 1 where all pixels lie on one line off the origin.
    printed_precision : float
        (2-5): the norm of the residual of X A = J over that of A, in pixels.
    precision, reliability : float
        Root mean square distance from the line in pixels, and sum of the distances over the
        extent (errata P1, P2), of the line with the least sum of squared distances.
    """

    pixels: int
    share: float
    printed_precision: float
    precision: float
    reliability: float


def fit_line(points: npt.ArrayLike) -> LineFit:
    """Fit the lines of (2-4) and of least distances to pixels and return their metrics.

    Parameters
    ----------
    points : (n, 2) array
        At least two different points.

    Raises
    ------
    InputError
        Fewer than two different points.

    References
    ----------
    Thesis (2-1)-(2-8), Appendix A; errata P1, P2.

    Examples
    --------
    >>> fit = fit_line([(1, 2), (2, 2), (3, 2), (4, 2)])
    >>> round(fit.share, 6), round(fit.precision, 6)
    (1.0, 0.0)
    >>> fit_line([(1, 2), (2, 2), (3, 3), (4, 3)]).share < 1
    True
    """
    pixels = _check.points(points)
    if len(pixels) < 2 or (pixels == pixels[0]).all():
        raise InputError("points", "at least two different points", f"{len(pixels)}")
    ones = np.ones(len(pixels))
    line = np.linalg.lstsq(pixels, ones, rcond=None)[0]
    fitted = pixels @ line
    size = float(np.hypot(*line))
    centred = pixels - pixels.mean(axis=0)
    normal = np.linalg.svd(centred, full_matrices=False)[2][1]
    distance = np.abs(centred @ normal).round(9)
    first, second = farthest_pair(pixels)
    return LineFit(
        len(pixels),
        float(fitted.sum()) / len(pixels),
        float(np.linalg.norm(fitted - ones)) / size if size > 0 else float("nan"),
        float(np.sqrt((distance**2).mean())),
        float(distance.sum()) / float(np.hypot(*(pixels[second] - pixels[first]))),
    )


def short_curves() -> dict[str, FloatArray]:
    """Return short digital curves, off the origin: exact lines, lines of other slopes, disturbed.

    Examples
    --------
    >>> short_curves()["horizontal"].shape
    (60, 2)
    """
    t = np.arange(60.0)
    heights = {
        "horizontal": 0 * t, "diagonal": t, "slope 1/2": t / 2, "slope 0.38": 0.38 * t,
        "spike of 3 px": 3.0 * (t == 8), "step of 2 px": np.where(t < 10, 0, 2),
        "bend": np.abs(t - 10) / 5, "arc": 0.004 * (t - 30) ** 2, "wave of 2 px": 2 * np.sin(t / 4),
    }  # fmt: skip
    return {k: np.stack([t + 7, np.floor(y + 0.5) + 20], axis=1) for k, y in heights.items()}


def duality_rows() -> list[tuple[str, LineFit]]:
    """Return the lines over the first 20 pixels and over all 60 of each short curve.

    Examples
    --------
    >>> name, fit = duality_rows()[0]
    >>> name, fit.precision, fit.reliability
    ('horizontal', 0.0, 0.0)
    """
    return [(k, fit_line(c[:n])) for k, c in short_curves().items() for n in (20, 60)]


def piece_rows(
    curves: Mapping[str, FloatArray], lengths: Sequence[int] = LENGTHS, every: int = 5
) -> dict[int, LineFit]:
    """Return length -> the means of the lines over pieces of so many pixels of closed curves.

    The share is the largest of all, for which (2-8) promises at most 1. Curves are moved off the
    origin; a piece starts at `every` so many pixels.

    Examples
    --------
    >>> t = np.linspace(0, 2 * np.pi, 400)
    >>> ring = np.rint(30 * np.stack([np.cos(t), np.sin(t)], axis=1))
    >>> found = piece_rows({"ring": ring}, (10, 40))
    >>> found[10].precision < found[40].precision
    True
    """
    found = {}
    for length in lengths:
        fits = [
            fit_line((curve - curve.min(axis=0) + 10.0)[np.arange(i, i + length) % len(curve)])
            for curve in curves.values()
            for i in range(0, len(curve) if len(curve) >= length else 0, every)
        ]
        if fits:
            names = ("printed_precision", "precision", "reliability")
            means = [float(np.mean([getattr(f, name) for f in fits])) for name in names]
            found[length] = LineFit(length, max(f.share for f in fits), *means)
    return found


def check_duality(pieces: Mapping[int, LineFit]) -> list[Claim]:
    """Check the claims of 2.2.2 on `piece_rows`.

    Examples
    --------
    >>> [claim.holds for claim in check_duality({})]
    [None, None, None]
    """
    lengths = sorted(pieces)
    share = max((pieces[m].share for m in lengths), default=0.0)
    figures = f"largest sum B / M {share:.6f}" if lengths else "no rows"
    claims = [Claim("2.2.2, A", "sum B <= M", share <= 1 + 1e-9 if lengths else None, figures)]
    for name, text, sign in (
        ("precision", "The fewer pixels, the better (lower) the precision of the line", 1),
        ("reliability", "The more pixels, the better (lower) the reliability of the line", -1),
    ):
        values = [getattr(pieces[m], name) for m in lengths]
        holds = bool((sign * np.diff(values) > 0).all()) if len(lengths) > 1 else None
        figures = ", ".join(f"{v:.2f} over {m} px" for m, v in zip(lengths, values, strict=True))
        claims.append(Claim("2.2.2", text, holds, figures))
    return claims
