"""Two peers that any OpenCV has, as examples of a detector given to `geoprim bench detectors`.

geoprim bench detectors --peer contours=benchmarks/peer_contours.py:fit_contours
"""

import cv2
import numpy as np


def fit_contours(image):
    """Fit an ellipse to every contour of the Canny edges, as many tutorials do."""
    contours, _ = cv2.findContours(canny(image), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    fits = [cv2.fitEllipse(c) for c in contours if len(c) >= 30]
    rows = [
        (x, y, max(w, h) / 2, min(w, h) / 2, np.deg2rad(turn) + (np.pi / 2 if h > w else 0))
        for (x, y), (w, h), turn in fits
        if min(w, h) > 2 and np.isfinite([x, y, w, h]).all()
    ]
    return np.array(rows).reshape(-1, 5)


def hough_circles(image):
    """Find circles with OpenCV's gradient Hough transform, at its usual settings."""
    smooth = cv2.medianBlur(gray(image), 5)
    side = min(smooth.shape)
    found = cv2.HoughCircles(
        smooth, cv2.HOUGH_GRADIENT, 1, side / 16, param1=100, param2=30, maxRadius=side // 2
    )
    if found is None:
        return np.zeros((0, 5))
    x, y, radius = np.asarray(found, dtype=np.float64).reshape(-1, found.shape[-1])[:, :3].T
    return np.column_stack([x, y, radius, radius, np.zeros(len(x))])[radius > 0]


def gray(image):
    """Return the gray image."""
    return image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def canny(image):
    """Return OpenCV's Canny edges after a light blur."""
    return cv2.Canny(cv2.GaussianBlur(gray(image), (5, 5), 1.0), 50, 150)
