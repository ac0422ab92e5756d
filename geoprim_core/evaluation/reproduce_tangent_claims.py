"""What thesis chapter 3 claims of its figures, checked on the results of a rerun."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from geoprim_core.evaluation.claims import Claim, make_claim
from geoprim_core.evaluation.reproduce_tangent import CONTROL_VALUES, ECCENTRICITIES, LOBES
from geoprim_core.evaluation.reproduce_tangent_run import Results
from geoprim_core.evaluation.tangent_errors import Row, order_of_convergence, pooled
from geoprim_core.tangent.bounds import conic_radius

THESIS = "deb(10)"
"""The entrant that the thesis proposes: DEB with R = 10."""


def check_claims(results: Results) -> list[Claim]:
    """Check every claim on the results of a rerun.

    Examples
    --------
    >>> empty = Results([], [], [], [], {}, [], [], {})
    >>> {claim.holds for claim in check_claims(empty) if claim.section > "3.5"}
    {None}
    """
    checks: tuple[Callable[[Results], Claim], ...] = (
        _second_test_worse,
        _flat_with_size,
        _a_tenth,
        _largest_radius,
        _analytic_maximum,
        _parabola_maximum,
        _analytic_bound_holds,
        _digital_bound_holds,
        _total_bound_holds,
        _circle_bound_holds,
        _walk_within_bound,
        _monotonic_on_circles,
        _best_beyond_fourteen,
        _parabolas_below_six,
        _lowest_on_circles,
        _lowest_on_ellipses,
        _segments_fail_on_thin_ellipses,
        _segments_fair_on_round_ellipses,
        _lr3_best_on_flowers,
        _deb_near_lr3,
        _lowest_maximum_on_flowers,
        _flowers_five_and_seven,
        _third_order,
        _isotropic,
    )
    return [check(results) for check in checks]


def _second_test_worse(results: Results) -> Claim:
    exact = [each.mean for each in results.sensitivity if not each.digitised]
    text = "Without digitisation the error of Yuen's centre is higher in test 2 than in test 1"
    figures = [f"means {exact[0]:.3f} and {exact[1]:.3f} of a"] if exact else []
    return make_claim("3.2.2.1", text, bool(exact) and exact[1] > exact[0], figures)


def _means_by_size(results: Results, test: int) -> list[float]:
    return [e.mean for e in results.sensitivity if e.digitised and e.test == test]


def _flat_with_size(results: Results) -> Claim:
    found = [_means_by_size(results, test) for test in (1, 2)]
    text = "With digitisation the mean error stays almost flat for a = 10 .. 100 (within 25 %)"
    figures = [f"test {k + 1}: {min(m):.3f} to {max(m):.3f}" for k, m in enumerate(found) if m]
    return make_claim("3.2.2.2", text, all(max(m) <= 1.25 * min(m) for m in found if m), figures)


def _a_tenth(results: Results) -> Claim:
    means = _means_by_size(results, 2)
    text = "The mean error of test 2 is about 0.1 (0.08 to 0.12)"
    figures = [f"{np.mean(means):.3f}"] if means else []
    about = bool(means) and bool(0.08 <= np.mean(means) <= 0.12)
    return make_claim("3.2.2.2", text, about, figures)


def _largest_radius(results: Results) -> Claim:
    largest = conic_radius(1e5, 100.0, 0.2)
    text = "With a = 100 and D_tol = 0.2 the largest R of (3-31) is 60"
    return make_claim("3.4.3", text, abs(largest - 60.0) < 1.0, [f"{largest:.1f} (D_tol a)"])


def _bounds(results: Results, family: str, radius: float | None = 10.0) -> list:  # type: ignore[type-arg]
    return [
        row
        for row in results.bounds
        if row.family == family and (radius is None or row.radius == radius)
    ]


def _printed_maximum(results: Results, family: str, text: str, value: float, place: str) -> Claim:
    rows = _bounds(results, family)
    measured = max((row.analytic for row in rows), default=0.0)
    printed = max((row.printed for row in rows), default=0.0)
    figures = [f"measured {measured:.4f}, (3-27) as printed {printed:.4f}"] if rows else []
    return make_claim(place, text, abs(measured - value) <= 0.02 * value, figures)


def _analytic_maximum(results: Results) -> Claim:
    text = "Conics with a = 200, R = 10: the largest analytic error is 0.035 degrees"
    return _printed_maximum(results, "conics", text, 0.035, "3.5.1.1")


def _parabola_maximum(results: Results) -> Claim:
    text = "Parabolae with a = 30 .. 500, R = 10: the largest analytic error is 0.3913 degrees"
    return _printed_maximum(results, "parabolae", text, 0.3913, "3.5.1.2")


def _share(rows: Sequence, name: str) -> list[str]:  # type: ignore[type-arg]
    places = sum(row.places for row in rows)
    worse = sum(getattr(row, name) > 0 for row in rows)
    points = sum(getattr(row, name) for row in rows)
    head = f"exceeded at {points} of {places} points, on {worse} of {len(rows)} (conic, R)"
    return [head] if rows else []


def _analytic_bound_holds(results: Results) -> Claim:
    rows = [row for row in results.bounds if row.family != "circles"]
    text = "The analytic error stays below (3-27) as printed"
    holds = not any(row.printed_exceeded for row in rows)
    return make_claim("3.4.1", text, holds, _share(rows, "printed_exceeded"))


def _digital_bound_holds(results: Results) -> Claim:
    text = "The error of the digitisation stays below (3-28) as printed"
    holds = not any(row.digital_exceeded for row in results.bounds)
    return make_claim("3.5", text, holds, _share(results.bounds, "digital_exceeded"))


def _total_bound_holds(results: Results) -> Claim:
    rows = [row for row in results.bounds if row.family != "circles"]
    text = "The error stays below the total bound (corrected: errata T2, T3) on conics, parabolae"
    return make_claim("3.5", text, not any(r.exceeded for r in rows), _share(rows, "exceeded"))


def _circle_bound_holds(results: Results) -> Claim:
    rows = _bounds(results, "circles", None)
    text = "On circles the analytic error is 0 and the error stays below the (corrected) bound"
    holds = all(row.analytic < 1e-6 and not row.exceeded for row in rows)
    return make_claim("3.5.1.3", text, holds, _share(rows, "exceeded"))


def _walk_within_bound(results: Results) -> Claim:
    rows = results.walks
    text = "DEB along the pixels of digitised circles stays below the total bound (not claimed)"
    beyond = sum(row.beyond_total for row in rows)
    figures = [f"above it at {beyond} of {sum(row.pixels for row in rows)} pixels"] if rows else []
    return make_claim("3.4.2", text, beyond == 0, figures)


def _curve(results: Results, method: str) -> dict[int, float]:
    """Return control value -> mean error on circles."""
    found = {row.label: row.mean for row in results.sweep if row.family == "sweep circle"}
    labels = {value: f"{method}({value})" for value in CONTROL_VALUES}
    return {value: found[label] for value, label in labels.items() if label in found}


def _rivals(results: Results) -> list[str]:
    methods = {row.label.split("(")[0] for row in results.sweep if row.family == "sweep circle"}
    return sorted(methods - {"deb"})


def _monotonic_on_circles(results: Results) -> Claim:
    errors = list(_curve(results, "deb").values())
    text = "On circles of radius 100 the mean error of DEB falls steadily as R grows"
    figures = [f"{errors[0]:.2f} at R = 2 to {errors[-1]:.2f} degrees at R = 30"] if errors else []
    return make_claim("3.6.3", text, bool((np.diff(errors) < 0).all()), figures)


def _best_beyond_fourteen(results: Results) -> Claim:
    deb, rivals = _curve(results, "deb"), _rivals(results)
    curves = {method: _curve(results, method) for method in rivals}
    ahead = [v for v in deb if all(deb[v] <= curve[v] for curve in curves.values())]
    always = [v for v in deb if all(w in ahead for w in deb if w >= v)]
    text = "For R >= 14 DEB is better on circles than every method with Q = R"
    figures = [f"from R = {min(always)} on" if always else "not up to R = 30"] if rivals else []
    if "lr1" in curves:
        over = [v for v in deb if all(deb[w] <= curves["lr1"][w] for w in deb if w >= v)]
        figures.append(f"overtakes LR1 at R = {min(over)}" if over else "never overtakes LR1")
    return make_claim("3.6.3", text, bool(always) and min(always) <= 14, figures)


def _parabolas_below_six(results: Results) -> Claim:
    deb = _curve(results, "deb")
    curves = [c for c in (_curve(results, "epf"), _curve(results, "ipf")) if c]
    text = "For R = Q <= 6 EPF and IPF are also better than DEB on circles"
    holds = all(curve[v] < deb[v] for curve in curves for v in curve if v <= 6)
    figures = [f"at 4: {curve[4]:.2f} against {deb[4]:.2f} of DEB" for curve in curves]
    return make_claim("3.6.3", text, holds, figures)


def _place(rows: dict[str, Row], label: str, name: str) -> int:
    return sorted(rows, key=lambda key: getattr(rows[key], name)).index(label) + 1


def _best(rows: dict[str, Row], name: str) -> str:
    label = min(rows, key=lambda key: getattr(rows[key], name))
    return f"best {label} {getattr(rows[label], name):.2f}"


def _lowest_on_circles(results: Results) -> Claim:
    rows = pooled(results.rows, "circle")
    ours = [label for label in rows if label.startswith("deb(")]
    text = "At its best R, DEB has the lowest mean and the lowest maximum error on circles"
    if len(rows) <= len(ours):
        return make_claim("3.6.3", text, False, [])
    deb = min(ours, key=lambda label: rows[label].mean)
    places = [_place(rows, deb, name) for name in ("mean", "maximum")]
    figures = [
        f"{deb}: {name} {getattr(rows[deb], name):.2f}, place {place} of {len(rows)}, "
        + _best(rows, name)
        for name, place in zip(("mean", "maximum"), places, strict=True)
    ]
    return make_claim("3.6.3", text, places == [1, 1], figures)


def _by_setting(results: Results, family: str, name: str) -> dict[str, dict[float, float]]:
    found: dict[str, dict[float, float]] = {}
    for row in results.rows:
        if row.family == family:
            found.setdefault(row.label, {})[row.setting] = getattr(row, name)
    return found


def _wins(found: dict[str, dict[float, float]], settings: Sequence[float]) -> int:
    """Return at how many settings no other method than DEB is below the thesis' one."""
    others = [curve for label, curve in found.items() if not label.startswith("deb")]
    ours = found.get(THESIS, {})
    return sum(all(ours[s] <= curve[s] for curve in others) for s in settings if s in ours)


def _lowest_on_ellipses(results: Results) -> Claim:
    found = _by_setting(results, "ellipse", "maximum")
    text = "DEB, R = 10, has the lowest maximum error for almost all (90 %) of the eccentricities"
    others = [label for label in found if not label.startswith("deb")]
    wins = _wins(found, ECCENTRICITIES)
    rows = pooled(results.rows, "ellipse")
    figures = [f"at {wins} of {len(ECCENTRICITIES)}"] if others else []
    if others:
        figures.append(f"its mean {rows[THESIS].maximum:.2f}, {_best(rows, 'maximum')}")
    return make_claim("3.6.4", text, wins >= 0.9 * len(ECCENTRICITIES), figures)


def _segments(results: Results) -> dict[str, dict[float, float]]:
    found = _by_setting(results, "ellipse", "maximum")
    return {label: found[label] for label in ("lambda_mst", "lambda_msg") if label in found}


def _segments_fail_on_thin_ellipses(results: Results) -> Claim:
    worst = {label: max(c[e] for e in c if e >= 0.5) for label, c in _segments(results).items()}
    text = "lambda-MSG and -MST come close to 90 degrees on many thin ellipses"
    figures = [f"{label}: at most {value:.1f}" for label, value in worst.items()]
    return make_claim("3.6.4", text, all(value > 80 for value in worst.values()), figures)


def _segments_fair_on_round_ellipses(results: Results) -> Claim:
    worst = {label: max(c[e] for e in c if e < 0.3) for label, c in _segments(results).items()}
    text = "lambda-MSG and -MST have reasonable errors (below 10 degrees) for e < 0.3"
    figures = [f"{label}: at most {value:.1f}" for label, value in worst.items()]
    return make_claim("3.6.4", text, all(value < 10 for value in worst.values()), figures)


def _lr3_best_on_flowers(results: Results) -> Claim:
    rows = pooled(results.rows, "flower")
    text = "On the flower curves LR3(3) has the lowest mean error"
    if "lr3_h3" not in rows:
        return make_claim("3.6.5", text, False, [])
    place = _place(rows, "lr3_h3", "mean")
    figures = [f"{rows['lr3_h3'].mean:.2f}, place {place} of {len(rows)}", _best(rows, "mean")]
    return make_claim("3.6.5", text, place == 1, figures)


def _deb_near_lr3(results: Results) -> Claim:
    rows = pooled(results.rows, "flower")
    text = "DEB, R = 10, comes really close to LR3(3) there (within 25 %)"
    if "lr3_h3" not in rows:
        return make_claim("3.6.5", text, False, [])
    ours, theirs = rows[THESIS].mean, rows["lr3_h3"].mean
    figures = [f"{ours:.2f} against {theirs:.2f} degrees"]
    return make_claim("3.6.5", text, ours <= 1.25 * theirs, figures)


def _lowest_maximum_on_flowers(results: Results) -> Claim:
    rows = pooled(results.rows, "flower")
    text = "DEB, R = 10, has the lowest maximum error on the flower curves"
    if all(label.startswith("deb") for label in rows):
        return make_claim("3.6.5", text, False, [])
    place = _place(rows, THESIS, "maximum")
    figures = [f"{rows[THESIS].maximum:.1f}, place {place} of {len(rows)}", _best(rows, "maximum")]
    return make_claim("3.6.5", text, place == 1, figures)


def _flowers_five_and_seven(results: Results) -> Claim:
    found = _by_setting(results, "flower", "mean")
    text = "DEB, R = 10, is better in the mean than lambda-MST on each flower curve"
    if "lambda_mst" not in found:
        return make_claim("3.6.5", text, False, [])
    pairs = {n: (found[THESIS][n], found["lambda_mst"][n]) for n in LOBES}
    figures = [f"n = {n}: {ours:.2f} / {theirs:.2f}" for n, (ours, theirs) in pairs.items()]
    return make_claim("3.6.5", text, all(a <= b for a, b in pairs.values()), figures)


def orders(results: Results) -> dict[str, dict[str, float]]:
    """Return label -> shape -> order k of the mean error c h^k on finer and finer grids.

    Examples
    --------
    >>> rows = [Row("grid circle", s, "a", 10.0 / s, 1.0, 1.0, 1.0) for s in (25, 50)]
    >>> found = orders(Results([], [], [], [], {}, [], rows, {}))
    >>> round(found["a"]["circle"], 6)
    1.0
    """
    series: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for row in results.grid:
        key = row.label, row.family.removeprefix("grid ")
        series.setdefault(key, []).append((row.setting, row.mean))
    found: dict[str, dict[str, float]] = {}
    for (label, shape), pairs in series.items():
        known = [pair for pair in pairs if np.isfinite(pair[1])]
        if len(known) > 1:
            sizes, errors = zip(*known, strict=True)
            found.setdefault(label, {})[shape] = order_of_convergence(sizes, errors)
    return found


def _third_order(results: Results) -> Claim:
    found = {label: o for label, o in orders(results).items() if label.startswith("deb(R")}
    text = "DEB is multigrid convergent of order 3 in h"
    figures = [
        f"{label}: " + ", ".join(f"{shape} {k:.2f}" for shape, k in each.items())
        for label, each in found.items()
    ]
    best = max((min(each.values()) for each in found.values()), default=0.0)
    return make_claim("3.4.3", text, best >= 2.5, figures)


def _isotropic(results: Results) -> Claim:
    found = results.directions.get(THESIS)
    text = "DEB is isotropic: its error does not depend on the direction (within 50 % of the mean)"
    if found is None:
        return make_claim("3.7", text, False, [])
    low, high = found.min() / found.mean(), found.max() / found.mean()
    return make_claim("3.7", text, low > 0.5 and high < 1.5, [f"{low:.2f} to {high:.2f} times"])
