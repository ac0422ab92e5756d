"""Grey image, gradient, thresholds and edge map: the Canny detector, thesis section 5.3."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import cast

import cv2
import numpy as np
import numpy.typing as npt

from geoprim_core._check import AnyArray, UInt32Array
from geoprim_core.edges import _kernels, _kernels_gradient
from geoprim_core.edges.params import EdgeParams

Float32Array = npt.NDArray[np.float32]

_BGR_WEIGHTS = (0.114, 0.587, 0.299)  # ITU-R BT.601 luma
_KERNEL_SUM = 128
_NO_OCTETS = np.zeros((0, 0), np.uint8)
_NO_LEVELS = np.zeros((0, 0), np.float32)
_RAYLEIGH_MEDIAN = math.sqrt(2.0 * math.log(2.0))
_NORMAL_MEDIAN = 0.67449  # of the magnitude
_SOBEL_VARIANCE = 0.5  # px^2, with the differences' own
_PURE_NOISE = math.sqrt(math.pi / 8.0)  # its standard deviation in typical gradients
_DROWNED = (0.74, 0.84)  # shares of that from which noise drowns the edges, a little and fully


@dataclass(frozen=True, slots=True, eq=False)
class Gradient:
    """The gradient of a blurred image, in grey levels per pixel.

    Attributes
    ----------
    dx, dy, magnitude : (H, W) float32
    blur : float
        Standard deviation of the Gaussian blur before it in pixels.
    largest : float
        The largest magnitude.
    typical : float
        The mean of the magnitudes weighted by themselves: flat ground does not count in it, and
        it grows in proportion to the contrast.
    noise : float
        Standard deviation of what is seen all over the image; 0 where that is too little to
        matter, or not measured (`measure_noise`).
    """

    dx: Float32Array
    dy: Float32Array
    magnitude: Float32Array
    blur: float
    largest: float
    typical: float
    noise: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The edge map of an image.

    Attributes
    ----------
    gradient : Gradient
    flat : (N,) uint32
        Flat indices of the edge pixels, rising.
    low, high : float
        Hysteresis thresholds on the magnitude, in grey levels per pixel.
    softness : float
        Standard deviation of the smoothing that most edges show in pixels; NaN: not known.
    """

    gradient: Gradient
    flat: UInt32Array
    low: float
    high: float
    softness: float = math.nan


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
    side = np.trim_zeros(side, "f")
    weights = np.concatenate((side, [_KERNEL_SUM - 2.0 * side.sum()], side[::-1]))
    return weights.astype(np.float32)


@lru_cache(maxsize=8)
def _half_of_weights(sigma: float) -> Float32Array:
    """Return the weights from the middle outwards, at least three."""
    weights = gaussian_weights(sigma)
    half = weights[len(weights) // 2 :]
    return np.concatenate((half, np.zeros(max(3 - len(half), 0), np.float32)))


def channels_of(image: AnyArray, params: EdgeParams) -> AnyArray:
    """Return the image whose gradient is taken, uint8 or float32: in colours or grey.

    With `colour` "strongest" the gradient of a colour image is, pixel by pixel, that of the channel
    where it is largest: red fruit on a belt of the same grey has an outline.
    """
    if image.ndim == 2 or params.colour == "gray" or params.equalise:
        return to_gray(image, equalise=params.equalise)
    return image if image.dtype == np.uint8 else _stretched(image[:, :, :3])


def steady_gradient(image: AnyArray, params: EdgeParams) -> Gradient:
    """Return the gradient of an image as `channels_of` gives it, blurred more where it is noisy.

    The standard deviation of the gradient's noise falls with the variance of the blur (that of
    the Sobel filter is 1/2), the height of an edge only with its root. So the blur grows until
    the noise is a share `noise_share` of the typical gradient, or to `noise_sigma`; where noise all
    but drowns the edges, to `drowned_sigma`. An image with less noise than that keeps its blur.

    References
    ----------
    J. Immerkaer, Fast noise variance estimation, CVIU 64 (1996), with the median.
    """
    found = measure_noise(gradient(image, params.sigma), params)
    share = _noise_share(image, found, params)
    growth = share / params.noise_share
    if not growth > 1.0:
        return found
    variance = growth**2 * (params.sigma**2 + _SOBEL_VARIANCE) - _SOBEL_VARIANCE
    sigma = min(_most_blur(share, params), math.sqrt(variance))
    return measure_noise(gradient(image, sigma), params)


def _most_blur(share: float, params: EdgeParams) -> float:
    """Return how far the blur may grow where noise is a `share` of the typical gradient."""
    first, full = _DROWNED
    drowned = min(1.0, max(0.0, (share / _PURE_NOISE - first) / (full - first)))
    return params.noise_sigma + drowned * max(0.0, params.drowned_sigma - params.noise_sigma)


def _noise_share(image: AnyArray, found: Gradient, params: EdgeParams) -> float:
    """Return the noise of the gradient in typical gradients, 0 where it is not looked at closely.

    It is the smaller one of two estimates: the median magnitude, which texture raises, and the
    noise of single pixels, which blur conceals.
    """
    least = params.noise_share * found.typical
    if params.noise_sigma <= params.sigma or found.noise <= least or min(image.shape[:2]) < 3:
        return 0.0
    effect = 1.0 / (math.sqrt(8.0 * math.pi) * (params.sigma**2 + _SOBEL_VARIANCE))
    single = effect * pixel_noise(image)
    return min(found.noise, single) / found.typical


def pixel_noise(image: AnyArray) -> float:
    """Return the standard deviation of the noise of an image, of colours in the middle one, green.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8 or float, H, W >= 3

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(100, 5, (200, 200))
    >>> 4.8 < pixel_noise(noise) < 5.2
    True
    """
    height, width = image.shape[:2]
    differences = np.empty((height - 2, width - 2), np.float32)
    largest = float(_kernels_gradient.checkers(*image_rows(image), differences))
    if not largest > 0.0:
        return 0.0
    median = float(_kernels.median_magnitude(differences, largest, 0.0))
    return median / (_NORMAL_MEDIAN * 6.0)  # the root of the weights' sum of squares


def image_rows(image: AnyArray) -> tuple[AnyArray, AnyArray, int]:
    """Return an image (H, W * C) as octets or as levels, the other one empty; how many channels."""
    rows = np.ascontiguousarray(image).reshape(len(image), -1)
    channels = 1 if image.ndim == 2 else 3
    if rows.dtype == np.uint8:
        return rows, _NO_LEVELS, channels
    return _NO_OCTETS, rows.astype(np.float32, copy=False), channels


def gradient(image: AnyArray, sigma: float) -> Gradient:
    """Return the gradient of an image: Gaussian blur, 3x3 Sobel, strongest channel.

    Its noise is not measured.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8 or float32
    """
    half = _half_of_weights(sigma)
    scale = np.float32(1.0 / (8.0 * _KERNEL_SUM**2))
    # Made here, not in the kernel: numpy asks the system for large pages.
    dx, dy, values = (np.empty(image.shape[:2], np.float32) for _ in range(3))
    largest, total, squares = _kernels_gradient.gradient(
        *image_rows(image), half, scale, dx, dy, values
    )
    # Rounded: the sums depend a little on the order, a turned image is to have the same edges.
    typical = _rounded(squares / total) if largest > 0.0 else 0.0
    return Gradient(dx, dy, values, sigma, float(largest), typical)


def measure_noise(found: Gradient, params: EdgeParams) -> Gradient:
    """Return a gradient with its noise, from the median magnitude."""
    if not found.largest > 0.0:
        return found
    share = params.noise_share
    if params.threshold_rule == "auto" and params.noise_factor > 0.0:
        share = min(share, params.high_auto / params.noise_factor)
    harmless = share * found.typical * _RAYLEIGH_MEDIAN
    median = float(_kernels.median_magnitude(found.magnitude, found.largest, harmless))
    return replace(found, noise=median / _RAYLEIGH_MEDIAN)


def find_edges(found: Gradient, params: EdgeParams) -> Edges:
    """Return the edges of a gradient: maxima along it, kept by two thresholds with hysteresis.

    References
    ----------
    Canny, A computational approach to edge detection, PAMI 8 (1986).
    """
    low, high = _thresholds(found, params)
    state = np.zeros(found.magnitude.shape, np.uint8)
    peaks = _kernels.suppress(found.magnitude, found.dx, found.dy, low, high, state)
    return Edges(found, _kernels.hysteresis(state, peaks), low, high)


def _rounded(value: float) -> float:
    """Return a number with its first twelve binary digits."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(mantissa * 2.0**12), exponent - 12)


def _thresholds(found: Gradient, params: EdgeParams) -> tuple[float, float]:
    if params.threshold_rule == "absolute":
        return params.low_gradient, params.high_gradient
    if params.threshold_rule == "fraction":
        return params.low_fraction * found.largest, params.high_fraction * found.largest
    low, high = params.low_auto * found.typical, params.high_auto * found.typical
    lift = max(1.0, params.noise_factor * found.noise / high) if high > 0.0 else 1.0
    return low * lift, high * lift
