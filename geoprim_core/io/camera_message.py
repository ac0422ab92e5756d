"""Cameras in and out of sensor_msgs/msg/CameraInfo, and the sorting that needs them."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core.applications import SortingParams, classify
from geoprim_core.errors import InputError
from geoprim_core.io.record import Record, header
from geoprim_core.types import Camera, Detections, EllipseDetections


def camera_from_message(info: Any, distance: float) -> Camera | None:
    """Return the camera of a CameraInfo above a plane, or None where it is not calibrated.

    The image is taken to be rectified. Binning and the region of interest are honoured.

    Parameters
    ----------
    info : object with the fields of sensor_msgs/msg/CameraInfo
    distance : float
        Distance of the working plane from the camera, in metres.

    Examples
    --------
    >>> camera = Camera(fx=800, fy=800, cx=320, cy=240, distance=0.6)
    >>> info = camera_record(camera, (640, 480), stamp_ns=0, frame_id="camera")
    >>> camera_from_message(info, distance=0.6).fx
    800.0
    """
    fx, _, cx, _, fy, cy = (float(v) for v in info.k[:6])
    if not (fx > 0 and fy > 0):
        return None
    step_x, step_y = info.binning_x or 1, info.binning_y or 1
    cx, cy = cx - info.roi.x_offset, cy - info.roi.y_offset
    # Binning keeps the corner of the image, which lies half a pixel before the first centre.
    middle = (cx + 0.5) / step_x - 0.5, (cy + 0.5) / step_y - 0.5
    return Camera(fx / step_x, fy / step_y, *middle, distance)


def camera_record(
    camera: Camera | None, image_size: tuple[int, int], stamp_ns: int, frame_id: str
) -> Record:
    """Return a sensor_msgs/msg/CameraInfo; for None that of a camera that is not calibrated."""
    k, r, p = np.zeros(9), np.zeros(9), np.zeros(12)
    if camera is not None:
        k[[0, 2, 4, 5, 8]] = camera.fx, camera.cx, camera.fy, camera.cy, 1.0
        r[[0, 4, 8]] = 1.0
        p[[0, 2, 5, 6, 10]] = camera.fx, camera.cx, camera.fy, camera.cy, 1.0
    none = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
    fields = {
        "header": header(stamp_ns, frame_id),
        "height": image_size[1],
        "width": image_size[0],
        "distortion_model": "" if camera is None else "plumb_bob",
        "d": np.zeros(0 if camera is None else 5),
        "k": k,
        "r": r,
        "p": p,
        "binning_x": 0,
        "binning_y": 0,
        "roi": Record("sensor_msgs/msg/RegionOfInterest", none),
    }
    return Record("sensor_msgs/msg/CameraInfo", fields)


def sort_objects(
    found: EllipseDetections, sorting: SortingParams, info: Any, plane_distance: float
) -> Detections:
    """Return the labelled objects; sizes in metres where camera and plane are known.

    Parameters
    ----------
    found : EllipseDetections
    sorting : SortingParams
    info : object with the fields of sensor_msgs/msg/CameraInfo, or None
    plane_distance : float
        In metres; 0 where it is not known.

    Raises
    ------
    InputError
        A class is in millimetres and the camera or the plane is not known.
    """
    known = info is not None and plane_distance > 0
    camera = camera_from_message(info, plane_distance) if known else None
    if camera is None and sorting.needs_camera:
        expected = "a calibrated camera_info and plane_distance, as a class is in mm"
        state = "no camera_info" if info is None else "a camera_info without focal length"
        raise InputError("camera", expected, state if plane_distance > 0 else "plane_distance 0")
    return classify(found, sorting, camera)
