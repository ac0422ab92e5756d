"""Kernels of Yuen's centre of an ellipse from three points and their tangents."""

from __future__ import annotations

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def centre_line(
    x: float, y: float, cos: float, sin: float, cos0: float, sin0: float
) -> tuple[float, float, float]:
    """Return A, B, C of the line A + B x - C y = 0 of (3-1) to (3-8), free of tan(theta).

    It joins the middle of two points with the intersection of their tangents. The second point
    is the origin; each coefficient is the printed one times cos(theta_1) cos(theta_2).
    """
    u = y * cos - x * sin
    v = y * cos0 - x * sin0
    return -u * v, -(sin0 * u + sin * v), -(cos0 * u + cos * v)


@kernel
def yuen_centre(
    table: FloatArray, i: int, j: int, k: int, min_sine: float
) -> tuple[bool, float, float]:
    """Return whether three rows (x, y, cos, sin) of a table give a centre, and its x and y."""
    x2, y2, cos2, sin2 = table[j, 0], table[j, 1], table[j, 2], table[j, 3]
    cos1, sin1, cos3, sin3 = table[i, 2], table[i, 3], table[k, 2], table[k, 3]
    if abs(cos1 * sin2 - sin1 * cos2) <= min_sine or abs(cos2 * sin3 - sin2 * cos3) <= min_sine:
        return False, 0.0, 0.0
    A12, B12, C12 = centre_line(table[i, 0] - x2, table[i, 1] - y2, cos1, sin1, cos2, sin2)
    A23, B23, C23 = centre_line(table[k, 0] - x2, table[k, 1] - y2, cos3, sin3, cos2, sin2)
    divisor = B12 * C23 - B23 * C12
    if divisor * divisor <= 1e-18 * (B12 * B12 + C12 * C12) * (B23 * B23 + C23 * C23):
        return False, 0.0, 0.0
    x = -(A12 * C23 - A23 * C12) / divisor
    y = -(A12 * B23 - A23 * B12) / divisor
    return True, x + x2, y + y2
