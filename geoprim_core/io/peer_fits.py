"""Ellipse fits of other libraries behind our face, as peers in comparisons."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core.types import Ellipse, EllipseFit


def opencv_fit_ellipse(points: npt.ArrayLike) -> EllipseFit:
    """Fit with cv2.fitEllipse.

    Examples
    --------
    >>> circle = [(5, 0), (0, 5), (-5, 0), (0, -5), (3, 4), (4, 3)]
    >>> round(opencv_fit_ellipse(circle).ellipse.semi_minor, 3)
    5.0
    """
    return _of_opencv(cv2.fitEllipse, points)


def opencv_fit_ellipse_ams(points: npt.ArrayLike) -> EllipseFit:
    """Fit with cv2.fitEllipseAMS (approximate mean square, Taubin)."""
    return _of_opencv(cv2.fitEllipseAMS, points)


def opencv_fit_ellipse_direct(points: npt.ArrayLike) -> EllipseFit:
    """Fit with cv2.fitEllipseDirect (Fitzgibbon)."""
    return _of_opencv(cv2.fitEllipseDirect, points)


def skimage_ellipse_model(points: npt.ArrayLike) -> EllipseFit:
    """Fit with scikit-image's EllipseModel (Halir and Flusser).

    Examples
    --------
    >>> skimage_ellipse_model([(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)]).ellipse is None
    True
    """
    from skimage.measure import EllipseModel

    cloud = _check.points(points)
    try:
        if hasattr(EllipseModel, "from_estimate"):  # since scikit-image 0.26
            with np.errstate(all="ignore"):
                model = EllipseModel.from_estimate(cloud)
            if not model:
                return EllipseFit(None, "no estimate")
            return _canonical((*model.center, *model.axis_lengths, model.theta))
        model = EllipseModel()
        return (
            _canonical(model.params) if model.estimate(cloud) else EllipseFit(None, "no estimate")
        )
    except (TypeError, ValueError, np.linalg.LinAlgError) as problem:  # complex axes, for instance
        return EllipseFit(None, str(problem))


def peer_fits() -> dict[str, Callable[[npt.ArrayLike], EllipseFit]]:
    """Return the fits of the libraries that are installed, by name.

    Examples
    --------
    >>> "cv2.fitEllipse" in peer_fits()
    True
    """
    peers: dict[str, Callable[[npt.ArrayLike], EllipseFit]] = {
        "cv2.fitEllipse": opencv_fit_ellipse,
        "cv2.fitEllipseAMS": opencv_fit_ellipse_ams,
        "cv2.fitEllipseDirect": opencv_fit_ellipse_direct,
    }
    if find_spec("skimage") is not None:
        peers["skimage.EllipseModel"] = skimage_ellipse_model
    return peers


def _of_opencv(fit: Callable[..., object], points: npt.ArrayLike) -> EllipseFit:
    """Call one of OpenCV's fits, which return centre, whole axes and an angle in degrees."""
    cloud = _check.points(points).astype(np.float32)
    try:
        box: Any = fit(cloud)
    except cv2.error as problem:
        return EllipseFit(None, str(problem))
    (x, y), (first, second), degrees = box
    return _canonical((x, y, first / 2, second / 2, np.radians(degrees)))


def _canonical(values: npt.ArrayLike) -> EllipseFit:
    """Return x, y, two semi-axes in any order and the angle of the first one as a fit."""
    x, y, first, second, angle = (float(value) for value in np.asarray(values, np.float64))
    if not (np.isfinite([x, y, first, second, angle]).all() and min(first, second) > 0):
        return EllipseFit(None, "axes that are none")
    if second > first:
        first, second, angle = second, first, angle + np.pi / 2
    angle %= np.pi
    return EllipseFit(Ellipse(x, y, first, second, angle if angle < np.pi else 0.0))
