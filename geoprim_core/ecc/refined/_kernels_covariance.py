"""Kernels of the `refined` scheme: what the scatter of the edge points says of an ellipse."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_refit import solve5

ANGLE_PRIOR = 12.0 / math.pi**2  # inverse variance of an angle of which nothing is known
ANGLE_HOLD = 1e-6  # of the weight of the centre, that holds an angle which nothing determines
LEAST_SLOPE = 0.3  # mean derivative of the weighted distances, however many points are far
LEAST_NOISE = 1e-10  # square pixels: exact points have none

# The noise of the distances at low frequencies along the outline, see `noise_of`.
POINTS_PER_WAVE = 8.0  # half-waves shorter than so many points tell of single points only
LEAST_WAVES, MOST_WAVES = 6, 20
OWN_SHARE = 0.1  # of a wave that must be left when what the ellipse takes up is removed
USUAL_WAVES = 6.0  # the usual ratio counts like so many waves
LEAST_FREE = 0.3  # share of the points that count as free, however few they are
USUAL_RATIO = 2.6  # of the noise at low frequencies to the variance, measured
# These two hold for edges smoothed with a standard deviation of a pixel and grow with it.
SMALL_SAMPLE = 5.5  # over the number of waves: what is added for not knowing the noise well
BLUR_DOUBT = 0.75  # pixels^2, by which the variance of a picture's own blur is unknown


@kernel
def wave_sums(distances: FloatArray, rows: FloatArray, waves: int) -> FloatArray:
    """Return the sums of derivatives (five) and of distances times cosine waves, flat.

    Each is a row of `MOST_WAVES` numbers of one array, so that the waves of a point compile to
    vector instructions: each takes its cosine from the two before, which it would wait for alone.
    """
    count = len(distances)
    work = np.zeros(9 * MOST_WAVES)
    now, before, double = 6 * MOST_WAVES, 7 * MOST_WAVES, 8 * MOST_WAVES
    for w in range(waves):
        work[double + w] = 2.0 * math.cos(math.pi * (w + 1) / count)
        work[now + w] = work[before + w] = math.cos(0.5 * math.pi * (w + 1) / count)
    for k in range(count):
        d, r0, r1, r2, r3, r4 = (
            distances[k], rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4],
        )  # fmt: skip
        for w in range(waves):
            cosine = work[now + w]
            work[w] += cosine * r0
            work[MOST_WAVES + w] += cosine * r1
            work[2 * MOST_WAVES + w] += cosine * r2
            work[3 * MOST_WAVES + w] += cosine * r3
            work[4 * MOST_WAVES + w] += cosine * r4
            work[5 * MOST_WAVES + w] += cosine * d
            work[now + w] = work[double + w] * cosine - work[before + w]
            work[before + w] = cosine
    return work


@kernel
def noise_of(
    distances: FloatArray, rows: FloatArray, inverse: FloatArray, smoothing: float
) -> float:
    """Return the variance per point of distances, in order, at low frequencies along an outline.

    Neighbouring edge points err alike, so the errors that move an ellipse are those at low
    frequencies. Cosine waves along the support, less the part that the ellipse has taken up
    (`rows` are the derivatives, `inverse` that of their normal matrix), measure them. The
    `smoothing` of the image in pixels is over how long neighbours err alike.

    References
    ----------
    Mueller, A theory of robust long-run variance estimation, Journal of Econometrics 141 (2007).
    """
    count = len(distances)
    variance = 0.0
    for k in range(count):
        variance += distances[k] * distances[k]
    # What an ellipse takes up is noise at low frequencies, more than that of five points.
    variance /= max(LEAST_FREE * count, count - 5.0 * USUAL_RATIO * smoothing)
    waves = min(MOST_WAVES, max(LEAST_WAVES, int(count / (POINTS_PER_WAVE * smoothing))))
    waves = min(waves, count // 3)
    power = USUAL_WAVES * USUAL_RATIO * smoothing * variance
    used = USUAL_WAVES
    sums = wave_sums(distances, rows, waves)
    for wave in range(waves):
        own = 0.5 * count
        for i in range(5):
            for j in range(5):
                own -= sums[i * MOST_WAVES + wave] * inverse[i, j] * sums[j * MOST_WAVES + wave]
        if own > OWN_SHARE * 0.5 * count:
            value = sums[5 * MOST_WAVES + wave]
            power += value * value / own
            used += 1.0
    return power / used * (1.0 + SMALL_SAMPLE / used)


@kernel
def inverse_of(matrix: FloatArray) -> tuple[FloatArray, bool]:
    """Return the inverse of a symmetric positive definite 5x5 matrix; False where it has none."""
    result = np.zeros((5, 5))
    for i in range(5):
        result[i, i] = 1.0
        if not solve5(matrix.copy(), result[i]):
            return result, False
    return 0.5 * (result + result.T), True


@kernel
def covariance_of(
    points: FloatArray, ellipse: FloatArray, width: float, smoothing: float
) -> FloatArray:
    """Return the covariance (5, 5) of an ellipse from the distances of its points, in order.

    That of an M-estimate with Tukey's weights of a `width` in pixels, from the noise at low
    frequencies along the outline in an image smoothed by `smoothing` pixels, and a systematic
    part: what a blur of the picture that nobody knows has moved the outline inwards. NaN when the
    points do not determine the ellipse.
    """
    count = len(points)
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    rows = np.empty((count, 5))
    distances = np.empty(count)
    bent = np.zeros(5)
    slope = 0.0
    for k in range(count):
        d, nx, ny = offset_of(ellipse, cos, sin, points[k, 0], points[k, 1])
        dx, dy = points[k, 0] - ellipse[0], points[k, 1] - ellipse[1]
        ct, st = (dx * cos + dy * sin) / a, (dy * cos - dx * sin) / b
        inverse_length = 1.0 / math.sqrt(ct * ct + st * st + 1e-300)
        ct, st = ct * inverse_length, st * inverse_length
        nu, nv = nx * cos + ny * sin, ny * cos - nx * sin
        row = rows[k]
        row[0], row[1], row[2], row[3] = nx, ny, ct * nu, st * nv
        row[4] = a * ct * nv - b * st * nu
        ratio = min(1.0, d * d / (width * width))
        distances[k] = (1.0 - ratio) * (1.0 - ratio) * d
        slope += (1.0 - ratio) * (1.0 - 5.0 * ratio)
        shift = 0.5 / radius_at(nu, nv, a, b)
        for i in range(5):
            bent[i] += row[i] * shift
    distances /= max(LEAST_SLOPE, slope / count)
    normal = rows.T @ rows
    scale = normal[0, 0] + normal[1, 1]
    # An angle that nothing determines must not make the normal matrix singular.
    regular = normal.copy()
    regular[4, 4] += ANGLE_HOLD * scale
    inverse, good = inverse_of(regular)
    if not good:
        return np.full((5, 5), np.nan)
    noise = max(noise_of(distances, rows, inverse, smoothing), LEAST_NOISE)
    normal /= noise
    normal[4, 4] += ANGLE_PRIOR
    result, good = inverse_of(normal)
    if not good:
        return np.full((5, 5), np.nan)
    drift = BLUR_DOUBT / noise * (result @ bent)
    for i in range(5):
        for j in range(5):
            result[i, j] += drift[i] * drift[j]
    return result


@kernel
def radius_at(nu: float, nv: float, a: float, b: float) -> float:
    """Return the radius of curvature of an ellipse where its unit normal is (nu, nv)."""
    square = a * a * nu * nu + b * b * nv * nv
    return a * a * b * b / (square * math.sqrt(square))
