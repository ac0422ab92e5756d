"""Metrics of an ellipse fit: distances of the points, and detections as in thesis 4.5.1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.evaluation._kernels_fitting import rosin_distances
from geoprim_core.fitting import distance_to_ellipse, overlap_matrix
from geoprim_core.types import Ellipse, Ellipses

MOST_SEMI_MAJOR = 200.0
"""A fitted ellipse with a semi-major axis of so many pixels or more is no detection (4.5.1, i)."""

LEAST_RATIO = 0.1
"""Nor is one whose axes have this ratio or a smaller one (4.5.1, ii)."""

LEAST_OVERLAP = 0.8
"""A detection is good where its overlap ratio with the truth is at least this (4.5.1)."""


@dataclass(frozen=True, slots=True)
class FitErrors:
    """Means over the points of a fit, in pixels.

    Attributes
    ----------
    mean_distance : float
        Of the orthogonal distances, d of thesis 4.5.1.
    e13 : float
        Of `focal_bisector_distance`.
    e14 : float
        Of `confocal_distance`.
    """

    mean_distance: float
    e13: float
    e14: float


@dataclass(frozen=True, slots=True)
class DetectionCounts:
    """Detections against truths, thesis 4.5.1.

    Attributes
    ----------
    truths : int
        Ellipses that are there.
    detected : int
        Ellipses that the method gives, within the limits on their axes.
    good : int
        Those of them that overlap a truth enough.
    found : int
        Truths that a detection overlaps enough. With one curve a truth it equals `good`.
    """

    truths: int = 0
    detected: int = 0
    good: int = 0
    found: int = 0

    @property
    def recall(self) -> float:
        """Found truths of all; NaN where there is none."""
        return self.found / self.truths if self.truths else float("nan")

    @property
    def precision(self) -> float:
        """Good detections of all; NaN where there is none."""
        return self.good / self.detected if self.detected else float("nan")

    def __add__(self, other: DetectionCounts) -> DetectionCounts:
        """Return the counts of both."""
        return DetectionCounts(
            self.truths + other.truths,
            self.detected + other.detected,
            self.good + other.good,
            self.found + other.found,
        )


def focal_bisector_distance(points: npt.ArrayLike, ellipse: Ellipse) -> FloatArray:
    """Return each point's distance to the ellipse along the bisector of the angle at the foci.

    On the outline that bisector is the normal. The nearer of its two crossings counts. On the
    straight line between the foci the bisector stands upright on it.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels.
    ellipse : Ellipse

    Returns
    -------
    (n,) float64
        In pixels, at least the orthogonal distance.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the ellipse is not an Ellipse.

    References
    ----------
    P. L. Rosin, "Analysing error of fit functions for ellipses", Pattern Recognition Letters 17,
    1996: the error of fit that uses the focal property. The thesis calls its measure of that
    paper E13 without a formula (errata E8); that this one is meant is an assumption: it is the
    best of that paper by the word of Rosin's paper of 1998.

    Examples
    --------
    >>> focal_bisector_distance([(7, 0), (0, 1)], Ellipse(0, 0, 5, 3, 0)).round(9).tolist()
    [2.0, 2.0]
    """
    return _rosin(points, ellipse)[:, 0].copy()


def confocal_distance(points: npt.ArrayLike, ellipse: Ellipse) -> FloatArray:
    """Return each point's distance to where the confocal hyperbola through it meets the ellipse.

    Confocal conics cross at right angles. With r and s the distances from the foci, the crossing
    has the eccentric angle of cosine 2 u / (r + s), u along the major axis.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels.
    ellipse : Ellipse

    Returns
    -------
    (n,) float64
        In pixels, at least the orthogonal distance.

    Raises
    ------
    InputError
        As `focal_bisector_distance`.

    References
    ----------
    P. L. Rosin, "Ellipse fitting using orthogonal hyperbolae and Stirling's oval", Graphical
    Models and Image Processing 60, 1998: the first of its two measures. The thesis calls its
    measure of that paper E14 without a formula (errata E8); that the hyperbola and not the oval
    is meant is an assumption.

    Examples
    --------
    >>> confocal_distance([(7, 0), (0, 1)], Ellipse(0, 0, 5, 3, 0)).tolist()
    [2.0, 2.0]
    """
    return _rosin(points, ellipse)[:, 1].copy()


def fit_errors(points: npt.ArrayLike, ellipse: Ellipse) -> FitErrors:
    """Return the mean errors of the points of a fit.

    Raises
    ------
    InputError
        There is no point, the points are not a finite (n, 2) array, or the ellipse is not one.

    Examples
    --------
    >>> errors = fit_errors([(7, 0), (0, 4)], Ellipse(0, 0, 5, 3, 0))
    >>> errors.mean_distance, round(errors.e13, 9), round(errors.e14, 9)
    (1.5, 1.5, 1.5)
    """
    cloud = _check.points(points)
    if len(cloud) == 0:
        raise InputError("points", "at least one point", "none")
    distance = distance_to_ellipse(cloud, ellipse)
    e13, e14 = _rosin(cloud, ellipse).mean(axis=0)
    return FitErrors(float(distance.mean()), float(e13), float(e14))


def accepted(ellipse: Ellipse | None) -> bool:
    """Tell whether a fit counts as a detection: conditions i and ii of thesis 4.5.1.

    Examples
    --------
    >>> accepted(Ellipse(0, 0, 199, 30, 0)), accepted(Ellipse(0, 0, 200, 30, 0)), accepted(None)
    (True, False, False)
    """
    if ellipse is None or ellipse.semi_major >= MOST_SEMI_MAJOR:
        return False
    return ellipse.semi_minor > LEAST_RATIO * ellipse.semi_major


def detection_counts(
    found: Sequence[Ellipse], truths: Sequence[Ellipse], least_overlap: float = LEAST_OVERLAP
) -> DetectionCounts:
    """Count detections against the truths of one curve or one image, thesis 4.5.1 and 4.5.3.

    Several detections of one truth are all good, as each edge curve is fitted for itself.

    Examples
    --------
    >>> disc, other = Ellipse(9, 9, 5, 5, 0), Ellipse(50, 50, 5, 5, 0)
    >>> detection_counts([disc, disc], [disc, other])
    DetectionCounts(truths=2, detected=2, good=2, found=1)
    """
    if not found or not truths:
        return DetectionCounts(len(truths), len(found))
    near = overlap_matrix(_ellipses(found), _ellipses(truths)) >= least_overlap
    return DetectionCounts(
        len(truths), len(found), int(near.any(axis=1).sum()), int(near.any(axis=0).sum())
    )


def _ellipses(items: Sequence[Ellipse]) -> Ellipses:
    rows = [(e.x, e.y, e.semi_major, e.semi_minor, e.angle) for e in items]
    return Ellipses.from_array(rows)


def _rosin(points: npt.ArrayLike, ellipse: Ellipse) -> FloatArray:
    cloud = _check.points(points)
    if not isinstance(ellipse, Ellipse):
        raise InputError("ellipse", "an Ellipse", describe(ellipse))
    row = np.array((ellipse.x, ellipse.y, ellipse.semi_major, ellipse.semi_minor, ellipse.angle))
    distances: FloatArray = rosin_distances(cloud, row)
    return distances
