"""Image points on the working plane in front of the camera, from sensor_msgs/msg/CameraInfo."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError

_STEPS = 20
_STEP = 1e-6  # of a ray, for derivatives
_CLOSE = 0.01  # pixels by which an undistorted point may miss where it came from
Lens = Callable[[FloatArray], FloatArray]

_MODELS = "plumb_bob, rational_polynomial or equidistant"


def points_on_plane(
    points: FloatArray, info: Any, distance: float, *, rectified: bool = False
) -> FloatArray:
    """Return where the rays through image points meet a plane square to the camera's axis.

    Parameters
    ----------
    points : (n, 2)
        In pixels of the image, whose binning and region of interest are honoured.
    info : object with the fields of sensor_msgs/msg/CameraInfo
    distance : float
        Of the plane from the camera, in metres.
    rectified : bool
        The image is rectified: the projection matrix P holds. Otherwise the camera matrix K and
        its distortion do, which is undone.

    Returns
    -------
    (n, 3) float64
        x right, y down, z forward in metres; NaN for a point that the model of the lens never
        reaches, as it may be outside the image.

    Raises
    ------
    InputError
        The distance is not positive, the camera is not calibrated, or the distortion is of a
        model that is not known.

    References
    ----------
    REP 104: CameraInfo.

    Examples
    --------
    >>> from geoprim_core.io.camera_message import camera_record
    >>> from geoprim_core.types import Camera
    >>> camera = Camera(fx=500, fy=500, cx=320, cy=240, distance=0.5)
    >>> info = camera_record(camera, (640, 480), stamp_ns=0, frame_id="camera")
    >>> points_on_plane(np.array([[320.0, 240.0], [420.0, 240.0]]), info, 0.5).tolist()
    [[0.0, 0.0, 0.5], [0.1, 0.0, 0.5]]
    """
    pixels = _full_resolution(_check.points(points), info)
    if not distance > 0:
        raise InputError("plane_distance", "more than 0 m", f"{distance}")
    rays = _rectified_rays(pixels, info, distance) if rectified else _rays(pixels, info)
    return np.column_stack([rays * distance, np.full(len(rays), float(distance))])


def pixel_size_on_plane(info: Any, distance: float) -> float:
    """Return how many metres of the plane one pixel of the image shows, on the camera's axis."""
    return float(distance * (info.binning_x or 1) / (info.k[0] or info.p[0] or np.inf))


def _full_resolution(points: FloatArray, info: Any) -> FloatArray:
    """Return pixels of the whole sensor, which K, P and the distortion speak of."""
    step = np.array([info.binning_x or 1, info.binning_y or 1], np.float64)
    start = np.array([info.roi.x_offset, info.roi.y_offset], np.float64)
    pixels: FloatArray = (points + 0.5) * step - 0.5 + start
    return pixels


def _rectified_rays(pixels: FloatArray, info: Any, distance: float) -> FloatArray:
    """Return x / z and y / z under P, whose last column is that of the second of two cameras."""
    p = np.asarray(info.p, np.float64).reshape(3, 4)
    focal = _focal(p, "p")
    rays: FloatArray = (pixels - p[:2, 2] - p[:2, 3] / distance) / focal
    return rays


def _rays(pixels: FloatArray, info: Any) -> FloatArray:
    """Return x / z and y / z under K, with the distortion undone."""
    k = np.asarray(info.k, np.float64).reshape(3, 3)
    d = np.asarray(info.d, np.float64)
    focal = _focal(k, "k")
    if not d.any() or not len(pixels):
        plain: FloatArray = (pixels - k[:2, 2]) / focal
        return plain
    return _undistorted(
        pixels, _lens(str(info.distortion_model), k, d), (pixels - k[:2, 2]) / focal
    )


def _undistorted(pixels: FloatArray, lens: Lens, start: FloatArray) -> FloatArray:
    """Return the rays that a lens shows at pixels, by Newton's steps from a start.

    Beyond the range of the model the image turns back or through the middle: NaN.
    """
    rays = start.copy()
    for _ in range(_STEPS):
        shown, slope = _with_slope(lens, rays)
        with np.errstate(all="ignore"):
            rays += np.linalg.solve(slope + 1e-12 * np.eye(2), (pixels - shown)[:, :, None])[
                :, :, 0
            ]
        rays = np.clip(np.nan_to_num(rays), -1e3, 1e3)
    shown, slope = _with_slope(lens, rays)
    ahead = (np.linalg.det(slope) > 0) & (np.trace(slope, axis1=1, axis2=2) > 0)
    good = (np.hypot(*(shown - pixels).T) < _CLOSE) & ahead
    rays[~good] = np.nan
    return rays


def _with_slope(lens: Lens, rays: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return where a lens shows rays, and the derivatives (n, 2, 2) of that."""
    shown = lens(rays)
    slope = [(lens(rays + _STEP * unit) - shown) / _STEP for unit in np.eye(2)]
    return shown, np.stack(slope, axis=2)


def _focal(matrix: FloatArray, name: str) -> FloatArray:
    focal: FloatArray = matrix[[0, 1], [0, 1]]
    if not (focal > 0).all():
        raise InputError(f"camera_info.{name}", "a calibrated camera", "no focal length")
    return focal


def _lens(name: str, k: FloatArray, d: FloatArray) -> Lens:
    """Return the lens of a distortion model: rays x / z, y / z to pixels."""
    common: Any = cv2.projectPoints
    models = dict.fromkeys(("plumb_bob", "rational_polynomial"), common)
    models |= dict.fromkeys(("equidistant", "fisheye"), cv2.fisheye.projectPoints)
    counts = (4,) if name in ("equidistant", "fisheye") else (4, 5, 8, 12, 14)
    if name not in models or len(d) not in counts:
        expected = f"{_MODELS}, or no distortion"
        raise InputError("camera_info.distortion_model", expected, f"{name!r}, {len(d)} numbers")

    def lens(rays: FloatArray) -> FloatArray:
        forward = np.column_stack([rays, np.ones(len(rays))])[:, None]
        pixels = models[name](forward, np.zeros(3), np.zeros(3), k, d)[0]
        shown: FloatArray = pixels.reshape(-1, 2)
        return shown

    return lens
