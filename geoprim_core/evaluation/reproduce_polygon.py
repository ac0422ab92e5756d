"""The experiments of thesis chapter 2, rerun: one row a table, curve and method."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import AnyArray, FloatArray, IntArray
from geoprim_core.edges import extract_contours
from geoprim_core.evaluation.polygon import (
    CurveMetrics,
    MeanMetrics,
    image_metrics,
    measure_polygon,
    set_metrics,
)
from geoprim_core.polygon import TABLE
from geoprim_core.synthetic import (
    FORMULA_CURVES,
    SILHOUETTES,
    degrade_curve,
    formula_curve,
    scaled_curve,
    silhouette,
)

DIVISORS = (2, 3, 4, 5)
COLUMNS = (
    "pixels",
    "vertices",
    "max_deviation",
    "ise",
    "figure_of_merit",
    "precision",
    "reliability",
    "compression_ratio",
)
_NOISY_SEEDS = (1, 2, 3)


@dataclass(frozen=True, slots=True)
class Variant:
    """A method with the values that a table of the thesis gives its parameters."""

    label: str
    table: str
    method: str
    values: tuple[tuple[str, float], ...] = ()

    def polygon(self, curve: FloatArray, *, closed: bool) -> IntArray:
        """Return the vertices of a curve."""
        row = TABLE[self.method]
        indices: IntArray = row.function(
            curve, closed=closed, params=row.params.from_dict(dict(self.values))
        )
        return indices


@dataclass(frozen=True, slots=True)
class Row:
    """One row of a table; `noise` and `divisor` tell what was done to the curve."""

    table: str
    curve: str
    label: str
    metrics: CurveMetrics
    divisor: int = 1
    noise: int = 0

    def cells(self) -> list[str | float]:
        """Return the row as it stands in a file."""
        values = [getattr(self.metrics, name) for name in COLUMNS]
        return [self.table, self.curve, self.label, self.divisor, self.noise, *values]


@dataclass(frozen=True, slots=True)
class SetRow:
    """One method over a set of images (Table 2.7-9)."""

    label: str
    metrics: MeanMetrics


def _variants() -> tuple[Variant, ...]:
    found = [
        Variant(f"PRO({e})", "2.3-1", "pro", (("tolerance", e),))
        for e in (0.2, 0.4, 0.6, 0.8, 1.0, 1.5)
    ]
    found += [Variant(f"RDP({d})", "2.5-1", "rdp", (("tolerance", d),)) for d in (1.0, 2.0)]
    found += [Variant("RDP(mod)", "2.5-1", "rdp_mod")]
    found += [Variant(f"Masood({d})", "2.5-2", "masood", (("tolerance", d),)) for d in (0.9, 1.2)]
    found += [Variant("Masood(mod)", "2.5-2", "masood_mod")]
    found += [Variant(f"Carmona({r})", "2.5-3", "carmona", (("ratio", r),)) for r in (0.3, 0.7)]
    found += [Variant("Carmona(mod)", "2.5-3", "carmona_mod")]
    return tuple(found)


VARIANTS = _variants()
PROPOSED = ("PRO(1.0)", "RDP(mod)", "Masood(mod)", "Carmona(mod)")
"""The four methods that the experiments of section 2.7 compare."""


def available(labels: tuple[str, ...] | None = None) -> tuple[Variant, ...]:
    """Return the variants, of these labels or all, whose method this version has.

    Examples
    --------
    >>> [variant.method for variant in available(("RDP(mod)",))]
    ['rdp_mod']
    """
    return tuple(
        v for v in VARIANTS if v.method in TABLE.names and (labels is None or v.label in labels)
    )


def own_curves() -> dict[str, FloatArray]:
    """Return the borders of the project's silhouettes by name.

    Examples
    --------
    >>> "hammer" in own_curves()
    True
    """
    return {name: silhouette(name) for name in SILHOUETTES}


def curve_rows(curves: Mapping[str, FloatArray]) -> Iterator[Row]:
    """Yield the rows of Tables 2.3-1 and 2.5-1 to 2.5-3: every variant on every closed curve.

    Examples
    --------
    >>> next(curve_rows({"bean": silhouette("bean")})).curve
    'bean'
    """
    for name, curve in curves.items():
        for variant in available():
            yield _row(variant.table, name, curve, variant)


def scaled_rows(curves: Mapping[str, FloatArray]) -> Iterator[Row]:
    """Yield the rows of Tables 2.7-1 to 2.7-4: the proposed methods on curves scaled down.

    Examples
    --------
    >>> rows = scaled_rows({"bean": silhouette("bean")})
    >>> sorted({row.divisor for row in rows})
    [1, 2, 3, 4, 5]
    """
    for k, label in enumerate(PROPOSED):
        for variant in available((label,)):
            for name, curve in curves.items():
                for divisor in (1, *DIVISORS):
                    small = scaled_curve(curve, divisor) if divisor > 1 else curve
                    yield _row(f"2.7-{k + 1}", name, small, variant, divisor=divisor)


def noisy_rows(curves: Mapping[str, FloatArray]) -> Iterator[Row]:
    """Yield the rows of Table 2.7-5: the proposed methods on clean curves and on noisy ones.

    Examples
    --------
    >>> rows = noisy_rows({"bean": silhouette("bean")})
    >>> sorted({row.noise for row in rows})
    [0, 1, 2, 3]
    """
    for name, curve in curves.items():
        noisy = {seed: degrade_curve(curve, seed) for seed in _NOISY_SEEDS}
        for variant in available(PROPOSED):
            for seed, version in {0: curve, **noisy}.items():
                yield _row("2.7-5", name, version, variant, noise=seed)


def formula_rows() -> Iterator[Row]:
    """Yield the rows of Tables 2.7-7 and 2.7-8, and those of the other kinds of each curve.

    Examples
    --------
    >>> next(formula_rows()).curve
    'curve_1 real'
    """
    for name in FORMULA_CURVES:
        for kind in ("real", "semi_digital", "digital"):
            curve = formula_curve(name, kind)
            for variant in available(PROPOSED):
                table = "2.7-8" if name == "sinc" else "2.7-7"
                yield _row(table, f"{name} {kind}", curve, variant, closed=False)


def image_rows(
    images: Mapping[str, AnyArray], after_image: Callable[[], object] | None = None
) -> list[SetRow]:
    """Return the rows of Table 2.7-9: every variant over the edge contours of all images.

    Images without contours are left out.

    Examples
    --------
    >>> from geoprim_core.synthetic import disc_image
    >>> disc = disc_image(60, 50, centre=(30, 25), radius=15)
    >>> image_rows({"disc": disc})[-1].metrics.count
    1
    """
    parts: dict[str, list[MeanMetrics]] = {variant.label: [] for variant in available()}
    for image in images.values():
        contours = extract_contours(image)
        for variant in available() if len(contours) else ():
            flags = contours.closed
            found = [
                measure_polygon(c, variant.polygon(c, closed=bool(f)), closed=bool(f))
                for c, f in zip(contours, flags, strict=True)
            ]
            parts[variant.label].append(image_metrics(found))
        if after_image is not None:
            after_image()
    return [SetRow(label, set_metrics(each)) for label, each in parts.items() if each]


def _row(
    table: str,
    name: str,
    curve: FloatArray,
    variant: Variant,
    *,
    closed: bool = True,
    divisor: int = 1,
    noise: int = 0,
) -> Row:
    indices = variant.polygon(curve, closed=closed)
    metrics = measure_polygon(curve, indices, closed=closed, span="first_pixel")
    return Row(table, name, variant.label, metrics, divisor, noise)


def duality_rows() -> list[tuple[str, int, float, float]]:
    """Return name, pixels, precision and reliability of lines fitted to short curves (2.2.2).

    The line of (2-4) does not exist where it passes through the origin; the line of least sum of
    squared distances takes its place. Axis-parallel and diagonal lines fit without error; for
    the others both metrics grow with the disturbance of the line.

    Examples
    --------
    >>> duality_rows()[0][2:]
    (0.0, 0.0)
    """
    t = np.arange(60.0)
    curves = {
        "horizontal": 0 * t, "diagonal": t, "slope 1/2": t / 2, "slope 0.38": 0.38 * t,
        "step of 2 px": np.where(t < 30, 0, 2), "bend": np.abs(t - 30) / 5,
        "arc": 0.004 * (t - 30) ** 2, "wave of 2 px": 2 * np.sin(t / 4),
    }  # fmt: skip
    rows = []
    for name, y in curves.items():
        for count in (20, 60):
            points = np.stack([t, np.floor(y + 0.5)], axis=1)[:count]
            centred = points - points.mean(axis=0)
            normal = np.linalg.svd(centred, full_matrices=False)[2][1]
            distance = np.abs(centred @ normal).round(9)
            extent = float(np.hypot(*(points[-1] - points[0])))
            precision = float(np.sqrt((distance**2).mean()))
            rows.append((name, count, precision, float(distance.sum()) / extent))
    return rows
