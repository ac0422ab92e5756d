"""The experiments of thesis chapter 2, rerun: one row a table, curve and method."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from geoprim_core._check import AnyArray, FloatArray, IntArray
from geoprim_core.edges import extract_contours
from geoprim_core.evaluation.polygon import (
    CurveMetrics,
    MeanMetrics,
    MeanRelative,
    RelativeMetrics,
    image_metrics,
    mean_relative,
    measure_polygon,
    relative_metrics,
    set_metrics,
)
from geoprim_core.polygon import TABLE
from geoprim_core.synthetic import (
    FORMULA_CURVES,
    SILHOUETTES,
    degrade_curve,
    formula_curve,
    shrunk_boundary,
    silhouette,
)
from geoprim_core.types import Contours

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
RELATIVE = ("fidelity", "efficiency", "merit")
LONGEST_JUDGED = 2000
"""Pixels of the longest curve that is held against the optimum, which takes seconds there."""
SHORTEST_JUDGED = 40
"""Pixels of the shortest contour of an image that is; most are specks, of which all is optimal."""
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
    """One row of a table; `noise` and `divisor` tell what was done to the curve.

    `relative` is missing where the curve is too long for the optimum.
    """

    table: str
    curve: str
    label: str
    metrics: CurveMetrics
    divisor: int = 1
    noise: int = 0
    relative: RelativeMetrics | None = None

    def cells(self) -> list[str | float]:
        """Return the row as it stands in a file."""
        values = [getattr(self.metrics, name) for name in COLUMNS]
        values += [getattr(self.relative, name, "") for name in RELATIVE]
        return [self.table, self.curve, self.label, self.divisor, self.noise, *values]


@dataclass(frozen=True, slots=True)
class SetRow:
    """One method over a set of images (Table 2.7-9).

    `relative` is taken over the `judged` contours of SHORTEST_JUDGED to LONGEST_JUDGED pixels,
    and missing where there are none; `curves` counts all.
    """

    images: str
    label: str
    metrics: MeanMetrics
    relative: MeanRelative | None = None
    judged: int = 0
    curves: int = 0


_OTHERS = (
    ("Lowe", "lowe"),
    ("Blurred segments", "blurred_segments"),
    ("Break points", "break_points"),
    ("Teh-Chin", "teh_chin"),
    ("Visvalingam", "visvalingam"),
)


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
    found += [Variant(label, "2.6", method) for label, method in _OTHERS]
    found += [Variant("Carmona(0.45)", "2.7-9", "carmona", (("ratio", 0.45),))]
    return tuple(found)


VARIANTS = _variants()
OVER_IMAGES = (
    "PRO(0.2)",
    "PRO(1.0)",
    "RDP(1.0)",
    "RDP(mod)",
    "Masood(0.9)",
    "Masood(mod)",
    "Carmona(0.45)",
    "Carmona(mod)",
)
"""The methods of Table 2.7-9, and PRO(0.2), of which its text speaks."""
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

    Methods of 2.6, of which the thesis has no table, follow with their default parameters.

    Examples
    --------
    >>> next(curve_rows({"bean": silhouette("bean")})).curve
    'bean'
    """
    for name, curve in curves.items():
        for variant in available():
            if variant.table == "2.7-9":
                continue
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
                    small = shrunk_boundary(curve, divisor) if divisor > 1 else curve
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
    images: Iterable[tuple[str, AnyArray]], after_image: Callable[[], object] | None = None
) -> list[SetRow]:
    """Return the rows of Table 2.7-9: every method over the edge contours of sets of images.

    Parameters
    ----------
    images : iterable of (set, image)
        Taken one by one; images without contours are left out.
    after_image : callable, optional
        Called after each.

    Examples
    --------
    >>> from geoprim_core.synthetic import disc_image
    >>> disc = disc_image(60, 50, centre=(30, 25), radius=15)
    >>> rows = image_rows([("discs", disc), ("discs", disc)])
    >>> rows[0].images, rows[0].label, rows[0].metrics.count
    ('discs', 'PRO(0.2)', 2)
    """
    parts: dict[tuple[str, str], list[_ImageRow]] = {}
    for name, image in images:
        contours = extract_contours(image)
        for variant in available(OVER_IMAGES) if len(contours) else ():
            parts.setdefault((name, variant.label), []).append(_image_row(contours, variant))
        if after_image is not None:
            after_image()
    return [_set_row(name, label, each) for (name, label), each in parts.items()]


_ImageRow = tuple[MeanMetrics, int, list[RelativeMetrics]]


def _image_row(contours: Contours, variant: Variant) -> _ImageRow:
    """Return the metrics of an image, how many contours it has, and the judgement of some."""
    found, judgement = [], []
    for curve, flag in zip(contours, contours.closed, strict=True):
        closed = bool(flag)
        indices = variant.polygon(curve, closed=closed)
        found.append(measure_polygon(curve, indices, closed=closed))
        relative = judge(curve, indices, closed=closed, shortest=SHORTEST_JUDGED)
        judgement += [relative] if relative is not None else []
    return image_metrics(found), len(found), judgement


def _set_row(name: str, label: str, images: Sequence[_ImageRow]) -> SetRow:
    relative = [mean_relative(judgement) for _, _, judgement in images if judgement]
    return SetRow(
        name,
        label,
        set_metrics([metrics for metrics, _, _ in images]),
        mean_relative(relative) if relative else None,
        sum(len(judgement) for _, _, judgement in images),
        sum(count for _, count, _ in images),
    )


def judge(
    curve: FloatArray, indices: IntArray, *, closed: bool, shortest: int = 2
) -> RelativeMetrics | None:
    """Return fidelity, efficiency and merit; None for a curve too short or too long for that.

    Examples
    --------
    >>> bean = silhouette("bean")
    >>> judge(bean, available(("RDP(mod)",))[0].polygon(bean, closed=True), closed=True).merit < 1
    True
    """
    if not shortest <= len(curve) <= LONGEST_JUDGED or len(indices) < 2:
        return None
    return relative_metrics(curve, indices, closed=closed)


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
    relative = judge(curve, indices, closed=closed)
    return Row(table, name, variant.label, metrics, divisor, noise, relative)
