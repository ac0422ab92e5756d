"""Ellipse fits of other libraries, as their own calls, to be timed beside ours."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import cv2

from geoprim_core._check import AnyArray

PeerCall = Callable[[AnyArray], object]
REFERENCE = "cv2.fitEllipseDirect"


def peer_calls() -> dict[str, PeerCall]:
    """Return OpenCV's three fits and, where it is installed, scikit-image's, by their names.

    Each takes points (n, 2) float32. OpenCV is held to one thread.

    Examples
    --------
    >>> list(peer_calls())[:3]
    ['cv2.fitEllipse', 'cv2.fitEllipseAMS', 'cv2.fitEllipseDirect']
    """
    cv2.setNumThreads(1)
    calls: dict[str, PeerCall] = {
        "cv2.fitEllipse": cv2.fitEllipse,  # type: ignore[dict-item]
        "cv2.fitEllipseAMS": cv2.fitEllipseAMS,  # type: ignore[dict-item]
        REFERENCE: cv2.fitEllipseDirect,  # type: ignore[dict-item]
    }
    if find_spec("skimage") is not None:
        calls["skimage EllipseModel"] = _scikit_image
    return calls


def _scikit_image(points: AnyArray) -> object:
    from skimage.measure import EllipseModel

    if hasattr(EllipseModel, "from_estimate"):  # since 0.26
        return EllipseModel.from_estimate(points)
    model = EllipseModel()
    return model.estimate(points)
