"""What thesis chapter 2 claims of its tables, checked on the rows of a rerun."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from geoprim_core.evaluation.claims import Claim
from geoprim_core.evaluation.claims import make_claim as _claim
from geoprim_core.evaluation.reproduce_polygon import PROPOSED, Row


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
        _compression_falls_with_scale,
        _precision_keeps_with_scale,
        _noise_and_compression,
        _noise_and_precision,
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
    values = list(_table(rows, "max_deviation", "RDP(mod)").values())
    text = "MD of RDP(mod) lies between 1.20 and 1.53 px on every curve"
    figures = [f"{min(values):.2f} to {max(values):.2f} px"] if values else []
    holds = bool(values) and min(values) >= 1.195 and max(values) <= 1.535
    return _claim("2.5.1.3", text, holds, figures)


def _rdp_mod_between(rows: Sequence[Row]) -> Claim:
    parts = [_table(rows, "ise", label) for label in ("RDP(1.0)", "RDP(mod)", "RDP(2.0)")]
    common = [c for c in parts[1] if c in parts[0] and c in parts[2]]
    inside = sum(parts[0][c] <= parts[1][c] <= parts[2][c] for c in common)
    text = "The ISE of RDP(mod) lies between those of RDP(1.0) and RDP(2.0)"
    figures = [f"{inside} of {len(common)} curves"] if common else []
    return _claim("2.5.1.3", text, inside == len(common), figures)


def _reliability_below_precision(rows: Sequence[Row]) -> Claim:
    precision = _table(rows, "precision", "RDP(mod)")
    reliability = _table(rows, "reliability", "RDP(mod)")
    lower = sum(reliability[curve] <= precision[curve] for curve in precision)
    text = "RDP(mod) has generally a lower reliability than precision metric (>= 80 % of curves)"
    figures = [f"{lower} of {len(precision)} curves"] if precision else []
    return _claim("2.5.1.3", text, lower >= 0.8 * len(precision), figures)


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
    ratios = _ratios(
        rows, "precision", {**_SCALED, "divisor": (1,)}, {**_SCALED, "divisor": (2, 3, 4, 5)}
    )
    text = "The precision metric does not change much with the size (means within 30 %)"
    holds = all(0.7 <= r <= 1.3 for r in ratios.values())
    return _of_all("2.7.1", text, holds, ratios)


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
    text = "Noise raises the precision metric of PRO(1.0), RDP(mod) and Carmona(mod)"
    return _of_all("2.7.2", text, all(r > 1 for r in others), ratios)
