"""Grey image, gradient, thresholds and edge map: the Canny detector, thesis section 5.3."""

from __future__ import annotations

import math
from typing import cast

import cv2
import numpy as np
import numpy.typing as npt

from geoprim_core._check import AnyArray, BoolArray
from geoprim_core.edges import _kernels
from geoprim_core.edges.params import EdgeParams

Float32Array = npt.NDArray[np.float32]

_BGR_WEIGHTS = (0.114, 0.587, 0.299)  # ITU-R BT.601 luma
_KERNEL_SUM = 128
_STRONG = 2
_RAYLEIGH_MEDIAN = math.sqrt(2.0 * math.log(2.0))


def to_gray(image: AnyArray, *, equalise: bool = False) -> AnyArray:
    """Return the grey image: uint8 for uint8 images, else float32 stretched to 0..255.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) array
        Colours are in OpenCV's order, blue, green, red (and alpha, which is left out).
    equalise : bool
        Equalise the histogram (errata C7); the result is then uint8.

    Examples
    --------
    >>> to_gray(np.array([[100, 300], [200, 100]], np.uint16))
    array([[  0. , 255. ],
           [127.5,   0. ]], dtype=float32)
    """
    gray = _luma(image)
    if gray.dtype != np.uint8:
        gray = _stretched(gray)
    if equalise:
        gray = cv2.equalizeHist(np.rint(gray).astype(np.uint8))
    return gray


def _luma(image: AnyArray) -> AnyArray:
    if image.ndim == 2:
        return np.ascontiguousarray(image)
    colours = np.ascontiguousarray(image[:, :, :3])
    if image.dtype == np.uint8:
        return cast(AnyArray, cv2.cvtColor(colours, cv2.COLOR_BGR2GRAY))
    return cast(AnyArray, sum(w * colours[:, :, c] for c, w in enumerate(_BGR_WEIGHTS)))


def _stretched(gray: AnyArray) -> Float32Array:
    low, high = 0.5 * float(gray.min()), 0.5 * float(gray.max())  # halves: no overflow
    if not high > low:
        return np.zeros(gray.shape, np.float32)
    scaled = (0.5 * gray.astype(np.float64) - low) / (high - low) * 255.0
    return cast(Float32Array, scaled.astype(np.float32))


def gaussian_weights(sigma: float) -> Float32Array:
    """Return Gaussian weights as whole numbers with the sum 128.

    With whole numbers the blur and the Sobel sums of an 8-bit image are exact in float32, so an
    image that is turned, mirrored or shifted has exactly the same gradients, turned with it.
    """
    radius = math.ceil(3.0 * sigma)
    tail = np.exp(-0.5 * (np.arange(radius, 0, -1) / max(sigma, 1e-9)) ** 2)
    steps = np.rint(np.cumsum(tail) * (_KERNEL_SUM / (1.0 + 2.0 * tail.sum())))
    side = np.diff(steps, prepend=0.0)
    weights = np.concatenate((side, [_KERNEL_SUM - 2.0 * side.sum()], side[::-1]))
    return weights.astype(np.float32)


def image_gradient(image: AnyArray, params: EdgeParams) -> tuple[Float32Array, Float32Array]:
    """Return the gradients dx, dy (H, W) of an image in levels per pixel.

    With `colour` "strongest" that of a colour image is, pixel by pixel, the gradient of the
    channel where it is largest: red fruit on a belt of the same grey has an outline.
    """
    if image.ndim == 2 or params.colour == "gray" or params.equalise:
        return gradient(to_gray(image, equalise=params.equalise), params.sigma)
    colours = image if image.dtype == np.uint8 else _stretched(image[:, :, :3])
    channels = cv2.split(np.ascontiguousarray(colours))[:3]
    dx, dy = gradient(channels[0], params.sigma)
    for channel in channels[1:]:
        _kernels.keep_stronger(dx, dy, *gradient(channel, params.sigma))
    return dx, dy


def gradient(gray: AnyArray, sigma: float) -> tuple[Float32Array, Float32Array]:
    """Return the gradients dx, dy (H, W) in grey levels per pixel: Gaussian blur, 3x3 Sobel."""
    weights = gaussian_weights(sigma)
    border = cv2.BORDER_REPLICATE
    smooth = cv2.sepFilter2D(gray, cv2.CV_32F, weights, weights, borderType=border)
    scale = 1.0 / (8.0 * _KERNEL_SUM**2)
    dx = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, scale=scale, borderType=border)
    dy = cv2.Sobel(smooth, cv2.CV_32F, 0, 1, scale=scale, borderType=border)
    return dx, dy


def find_edges(
    dx: Float32Array, dy: Float32Array, params: EdgeParams
) -> tuple[BoolArray, float, float]:
    """Return the edge map (H, W) and the low and high threshold in grey levels per pixel."""
    values = _kernels.magnitude(dx, dy)
    low, high = _thresholds(values, params)
    state = _kernels.suppress(values, dx, dy, low, high)
    _kernels.spread(state, np.flatnonzero(state == _STRONG))
    return state == _STRONG, low, high


def _thresholds(values: Float32Array, params: EdgeParams) -> tuple[float, float]:
    if params.threshold_rule == "absolute":
        return params.low_gradient, params.high_gradient
    largest = float(values.max())
    if params.threshold_rule == "fraction":
        return params.low_fraction * largest, params.high_fraction * largest
    return _automatic(values, largest, params)


def _automatic(values: Float32Array, largest: float, params: EdgeParams) -> tuple[float, float]:
    """Return thresholds in units of the typical gradient, above the noise.

    The typical gradient is the mean of the magnitude weighted by itself (sum of squares over
    sum): flat ground does not count in it, and it grows in proportion to the contrast.
    """
    if not largest > 0.0:
        return 0.0, 0.0
    flat = values.ravel()
    typical = float(np.vdot(flat, flat)) / float(flat.sum())
    low, high = params.low_auto * typical, params.high_auto * typical
    if params.noise_factor > 0.0 and high > 0.0:
        noise = _kernels.median_magnitude(values, largest) / _RAYLEIGH_MEDIAN
        lift = max(1.0, params.noise_factor * noise / high)
        low, high = low * lift, high * lift
    return low, high
