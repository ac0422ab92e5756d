"""OpenCV's EdgeDrawing as a peer of `geoprim bench detectors`; needs opencv-contrib.

    geoprim bench detectors --peer ED=benchmarks/peer_edge_drawing.py:detect --peer-python PYTHON

References: C. Akinlar and C. Topal, EDCircles, Pattern Recognition 46, 2013.
"""

import cv2
import numpy as np


def detect(image):
    """Return x, y, semi_major, semi_minor, angle of every circle and ellipse; own defaults."""
    return run(image, cv2.ximgproc.EdgeDrawing.Params())


def detect_parameter_free(image):
    """As `detect`, in the mode without a gradient threshold."""
    params = cv2.ximgproc.EdgeDrawing.Params()
    params.PFmode = True
    return run(image, params)


def run(image, params):
    """Detect with given settings."""
    detector = cv2.ximgproc.createEdgeDrawing()
    detector.setParams(params)
    gray = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    detector.detectEdges(gray)
    return rows(detector.detectEllipses())


def rows(found):
    """Turn OpenCV's rows (x, y, radius of a circle or 0, semi-axes, degrees) into ours."""
    if found is None:
        return np.zeros((0, 5))
    values = np.asarray(found, dtype=np.float64).reshape(-1, 6)
    x, y, radius, first, second, degrees = values.T
    p, q = radius + first, radius + second
    angle = np.deg2rad(degrees) + np.where(q > p, np.pi / 2, 0)
    return np.column_stack([x, y, np.maximum(p, q), np.minimum(p, q), angle % np.pi])
