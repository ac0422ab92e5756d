"""What thesis chapter 2 claims of its tables, checked on the rows of a rerun."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from geoprim_core.evaluation.claims import Claim
from geoprim_core.evaluation.claims import make_claim as _claim
from geoprim_core.evaluation.reproduce_polygon import PROPOSED, Row, SetRow
from geoprim_core.evaluation.thesis_tables import FORMULA, METHODS
from geoprim_core.polygon import deviation_bound


def check_claims(rows: Sequence[Row]) -> list[Claim]:
    """Check every claim on the rows of a rerun.

    Examples
    --------
    >>> all(claim.holds is None for claim in check_claims([]))
    True
    """
    checks: tuple[Callable[[Sequence[Row]], Claim], ...] = (
        _pro_follows_its_tolerance,
        _deviation_of_rdp_mod,
        _rdp_mod_between,
        _reliability_below_precision,
        _deviation_of_masood_mod,
        _masood_mod_and_its_original,
        _masood_is_local,
        _deviation_of_carmona_mod,
        _compression_falls_with_scale,
        _precision_keeps_with_scale,
        _noise_and_compression,
        _noise_and_precision,
        _off_the_grid,
    )
    return [check(rows) for check in checks]


Choice = Mapping[str, tuple[object, ...]]
"""Field of a row -> the values wanted of it."""


def _means(
    rows: Sequence[Row], name: str, label: str, **wanted: tuple[object, ...]
) -> dict[str, float]:
    """Return curve -> mean of a metric over the rows that match."""
    values: dict[str, list[float]] = {}
    for row in rows:
        if row.label == label and all(getattr(row, key) in value for key, value in wanted.items()):
            values.setdefault(row.curve, []).append(float(getattr(row.metrics, name)))
    return {curve: float(np.mean(each)) for curve, each in values.items()}


def _pro_follows_its_tolerance(rows: Sequence[Row]) -> Claim:
    labels = [f"PRO({e})" for e in (0.2, 0.4, 0.6, 0.8, 1.0, 1.5)]
    means = {
        name: [np.mean(list(found.values())) for v in labels if (found := _table(rows, name, v))]
        for name in ("vertices", "precision", "reliability")
    }
    rises = all((np.diff(means[name]) >= 0).all() for name in ("precision", "reliability"))
    falls = bool((np.diff(means["vertices"]) <= 0).all())
    text = "With epsilon_0 the precision and reliability metrics of PRO grow and N falls (means)"
    figures = [f"{name} " + " ".join(f"{v:.2f}" for v in means[name]) for name in means]
    return _claim("2.3.2", text, rises and falls, figures if means["vertices"] else [])


def _table(rows: Sequence[Row], name: str, label: str) -> dict[str, float]:
    return _means(rows, name, label, table=("2.3-1", "2.5-1", "2.5-2", "2.5-3"))


def _deviation_of_rdp_mod(rows: Sequence[Row]) -> Claim:
    return _deviation_between(rows, "2.5.1.3", "RDP(mod)", 1.20, 1.53)


def _deviation_between(
    rows: Sequence[Row], section: str, label: str, low: float, high: float
) -> Claim:
    values = list(_table(rows, "max_deviation", label).values())
    text = f"MD of {label} lies between {low:.2f} and {high:.2f} px on every curve"
    figures = [f"{min(values):.2f} to {max(values):.2f} px"] if values else []
    holds = bool(values) and min(values) >= low - 0.005 and max(values) <= high + 0.005
    return _claim(section, text, holds, figures)


def _rdp_mod_between(rows: Sequence[Row]) -> Claim:
    shares = {}
    for name in ("ise", "compression_ratio", "precision", "reliability"):
        parts = [_table(rows, name, label) for label in ("RDP(1.0)", "RDP(mod)", "RDP(2.0)")]
        common = [c for c in parts[1] if c in parts[0] and c in parts[2]]
        inside = sum(parts[0][c] <= parts[1][c] <= parts[2][c] for c in common)
        if common:
            shares[name] = (inside, len(common))
    text = "ISE, CR, precision, reliability of RDP(mod) lie between those of RDP(1.0) and RDP(2.0)"
    figures = [f"{name} {inside} of {count} curves" for name, (inside, count) in shares.items()]
    return _claim("2.5.1.3", text, all(i == n for i, n in shares.values()), figures)


def _reliability_below_precision(rows: Sequence[Row]) -> Claim:
    precision = _table(rows, "precision", "RDP(mod)")
    reliability = _table(rows, "reliability", "RDP(mod)")
    lower = sum(reliability[curve] <= precision[curve] for curve in precision)
    text = "RDP(mod) has generally a lower reliability than precision metric (>= 80 % of curves)"
    figures = [f"{lower} of {len(precision)} curves"] if precision else []
    return _claim("2.5.1.3", text, lower >= 0.8 * len(precision), figures)


def _deviation_of_masood_mod(rows: Sequence[Row]) -> Claim:
    return _deviation_between(rows, "2.5.2.3", "Masood(mod)", 0.79, 1.27)


def _masood_mod_and_its_original(rows: Sequence[Row]) -> Claim:
    changed, loose = (_table(rows, "max_deviation", f"Masood({p})") for p in ("mod", "1.2"))
    ratio, tight = (_table(rows, "compression_ratio", f"Masood({p})") for p in ("mod", "0.9"))
    less = sum(changed[c] < loose[c] for c in changed)
    better = sum(ratio[c] > tight[c] for c in ratio)
    text = "Masood(mod) has a lower MD than Masood(1.2) and a higher CR than Masood(0.9)"
    figures = [f"MD {less}, CR {better} of {len(changed)} curves"] if changed else []
    return _claim("2.5.2.3", text, less == better == len(changed), figures)


def _masood_is_local(rows: Sequence[Row]) -> Claim:
    names = ("precision", "reliability", "compression_ratio")
    pairs = {
        name: [list(_table(rows, name, v).values()) for v in ("Masood(mod)", "RDP(mod)")]
        for name in names
    }
    text = "Precision, reliability and CR of Masood(mod) are lower than those of RDP(mod) (means)"
    if not all(values for pair in pairs.values() for values in pair):
        return _claim("2.5.2.3", text, False, [])
    means = {name: [float(np.mean(v)) for v in pair] for name, pair in pairs.items()}
    figures = [f"{name} {ours:.2f} against {other:.2f}" for name, (ours, other) in means.items()]
    return _claim("2.5.2.3", text, all(a < b for a, b in means.values()), figures)


def _deviation_of_carmona_mod(rows: Sequence[Row]) -> Claim:
    parts = [list(_table(rows, "max_deviation", f"Carmona({p})").values()) for p in (0.3, 0.7)]
    old = [value for part in parts for value in part]
    new = list(_table(rows, "max_deviation", "Carmona(mod)").values())
    text = "MD spreads less under Carmona(mod) (printed 1.29-2.73 px) than originally (0.49-6.75)"
    if not old or not new:
        return _claim("2.5.3.3", text, False, [])
    ranges = [f"{min(v):.2f} to {max(v):.2f} px" for v in (new, old)]
    holds = max(new) - min(new) < max(old) - min(old)
    return _claim("2.5.3.3", text, holds, [f"{ranges[0]} against {ranges[1]}"])


_SCALED: Choice = {"table": ("2.7-1", "2.7-2", "2.7-3", "2.7-4")}


def _ratios(rows: Sequence[Row], name: str, before: Choice, after: Choice) -> dict[str, float]:
    """Return label -> mean over the curves of the metric after / before, where that was not 0."""
    found = {}
    for label in PROPOSED:
        old = list(_means(rows, name, label, **before).values())
        new = list(_means(rows, name, label, **after).values())
        if old and new and np.mean(old) > 0:
            found[label] = float(np.mean(new) / np.mean(old))
    return found


def _of_all(section: str, text: str, holds: bool, ratios: dict[str, float]) -> Claim:
    """Return a claim on all proposed methods; it is open while one of them is missing."""
    figures = "; ".join(f"{label} x{ratio:.2f}" for label, ratio in ratios.items())
    known = len(ratios) == len(PROPOSED)
    return Claim(section, text, holds if known else None, figures or "no rows")


def _compression_falls_with_scale(rows: Sequence[Row]) -> Claim:
    ratios = _ratios(
        rows, "compression_ratio", {**_SCALED, "divisor": (1,)}, {**_SCALED, "divisor": (5,)}
    )
    text = "At a fifth of the size CR falls for all four methods"
    return _of_all("2.7.1", text, all(r < 1 for r in ratios.values()), ratios)


def _precision_keeps_with_scale(rows: Sequence[Row]) -> Claim:
    names = ("max_deviation", "precision", "reliability")
    found = {
        name: _ratios(
            rows, name, {**_SCALED, "divisor": (1,)}, {**_SCALED, "divisor": (2, 3, 4, 5)}
        )
        for name in names
    }
    text = "MD, precision and reliability do not change much with the size (means within 30 %)"
    ratios = {f"{name} of {k}": r for name in names for k, r in found[name].items()}
    holds = all(0.7 <= r <= 1.3 for r in ratios.values())
    known = len(ratios) == len(names) * len(PROPOSED)
    figures = "; ".join(f"{label} x{ratio:.2f}" for label, ratio in ratios.items())
    return Claim("2.7.1", text, holds if known else None, figures or "no rows")


_CLEAN: Choice = {"table": ("2.7-5",), "noise": (0,)}
_NOISY: Choice = {"table": ("2.7-5",), "noise": (1, 2, 3)}


def _noise_and_compression(rows: Sequence[Row]) -> Claim:
    ratios = _ratios(rows, "compression_ratio", _CLEAN, _NOISY)
    others = [r for label, r in ratios.items() if label != "Masood(mod)"]
    masood = ratios.get("Masood(mod)", 0.0)
    text = "Noise leaves CR about the same (within 20 %), but for Masood(mod), where it falls"
    holds = all(abs(r - 1) <= 0.2 for r in others) and masood < min(others, default=1.0)
    return _of_all("2.7.2", text, holds, ratios)


def _noise_and_precision(rows: Sequence[Row]) -> Claim:
    ratios = _ratios(rows, "precision", _CLEAN, _NOISY)
    others = [r for label, r in ratios.items() if label != "Masood(mod)"]
    text = "Noise raises the precision metric of PRO(1.0), RDP(mod) and Carmona(mod), >= 10 %"
    return _of_all("2.7.2", text, all(r >= 1.1 for r in others), ratios)


def _off_the_grid(rows: Sequence[Row]) -> Claim:
    found: dict[str, float] = {}
    for row in rows:
        if row.table in ("2.7-7", "2.7-8") and row.curve.endswith("real"):
            found[row.label] = max(found.get(row.label, 0.0), row.metrics.max_deviation)
    printed = {k: max(FORMULA[curves][i][1] for curves in FORMULA) for i, k in enumerate(METHODS)}
    text = "The methods stay as close to real-valued curves as printed: MD (at most 10 % more)"
    figures = [f"{k} {v:.2f} px, printed {printed[k]:.2f}" for k, v in found.items()]
    holds = all(v <= 1.1 * printed[k] for k, v in found.items())
    return _claim("2.7.3", text, holds, figures)


def check_images(sets: Sequence[SetRow]) -> list[Claim]:
    """Check the claims of 2.7.4 on the means over all sets of images.

    Examples
    --------
    >>> check_images([])
    []
    """
    if not sets:
        return []
    names = ("precision", "reliability", "max_deviation", "ise", "compression_ratio")
    means = {
        label: {
            name: float(np.mean([getattr(r.metrics, name) for r in sets if r.label == label]))
            for name in names
        }
        for label in dict.fromkeys(row.label for row in sets)
    }
    claims = []
    for old, new in (("Masood(0.9)", "Masood(mod)"), ("Carmona(0.45)", "Carmona(mod)")):
        pairs = [(means[new][n], means[old][n]) for n in names[:3]]
        figures = [f"{n} {a:.2f} / {b:.2f}" for n, (a, b) in zip(names, pairs, strict=False)]
        text = f"Precision, reliability and MD of {new} are lower than those of {old} (means)"
        claims.append(_claim("2.7.4", text, all(a < b for a, b in pairs), figures))
    least = {name: min(means, key=lambda label: means[label][name]) for name in names}
    text = "PRO(0.2) has the lowest precision, reliability, MD, ISE and CR of all"
    figures = [f"{name} {label}" for name, label in least.items()]
    claims.append(_claim("2.7.4", text, set(least.values()) == {"PRO(0.2)"}, figures))
    return claims


def check_bounds() -> list[Claim]:
    """Check the claims of 2.4 on the digitisation bounds.

    Examples
    --------
    >>> [claim.holds for claim in check_bounds()]
    [True, False]
    """
    degrees = np.radians(np.arange(0.0, 90.1, 0.5))
    along = np.stack([np.cos(degrees), np.sin(degrees)], axis=1)
    limits = {
        rule: max(deviation_bound((0, 0), 1e6 * end, rule) for end in along)
        for rule in ("thesis", "exact", "dss4", "tan")
    }
    text = "The largest d_dig and d_tan of long segments and the largest d_DSS are sqrt(2) (2-52)"
    figures = [f"{rule} {limit:.4f}" for rule, limit in limits.items()]
    holds = all(abs(limit - 2**0.5) < 1e-3 for limit in limits.values())
    claims = [_claim("2.4.3.3", text, holds, figures)]
    ratios = [
        deviation_bound((0, 0), s * end, "exact") / deviation_bound((0, 0), s * end, "thesis")
        for s in (3.0, 5.0, 10.0, 20.0, 50.0)
        for end in along
    ]
    beyond = 100 * float(np.mean(np.array(ratios) > 1 + 1e-9))
    text = "(2-36) is an upper bound of the turn of a digitised segment (3 to 50 px)"
    figures = [f"exceeded in {beyond:.0f} % of the cases, up to x{max(ratios):.2f} (errata P4)"]
    return [*claims, _claim("2.4.1", text, beyond == 0, figures)]
