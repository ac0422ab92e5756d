"""What thesis 4.5 and 4.6 claim of ElliFit and the others, checked on the outcomes of a rerun."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from geoprim_core.evaluation.claims import Claim
from geoprim_core.evaluation.reproduce_fitting import Outcome
from geoprim_core.evaluation.reproduce_fitting_outcomes import (
    Measure,
    Outcomes,
    detected,
    precision,
    recall,
)

THESIS_METHODS = ("ellifit", "fitzgibbon", "chaudhuri", "harker", "ahn", "maini", "liu")
"""The methods that thesis 4.5 compares."""

_OTHERS = THESIS_METHODS[1:]
_ERRORS = ("e13", "e14", "distance")


def check_claims(outcomes: Outcomes) -> list[Claim]:
    """Check every claim on the outcomes of a rerun.

    Examples
    --------
    >>> all(claim.holds is None for claim in check_claims(Outcomes([])))
    True
    """
    claims = [_least_error("4.5.1", "ElliFit has the lowest {} at every span", m) for m in _ERRORS]
    claims += [
        _all_but_135, _close_to_all, _harker_below, _ahn_detects_fewer, _noise_least,
        _ahn_at_high_noise, _third, _most_detections, _recall_near_one, _sector_detections,
        _sector_ahn, _images_error, _images_total, _images_recall, _images_ahn,
        _open_analytic, _open_digital, _fewest_false, _false_at_thirty, _none_at_ninety,
        _ahn_second, _up_to_twenty,
    ]  # fmt: skip
    for section in ("4.5.2", "4.5.2 sector"):
        claims.append(_least_error(section, "ElliFit has the lowest {} at every noise", "e14"))
    found = [claim(outcomes) for claim in claims]
    return sorted(found, key=lambda claim: claim.section)


def _claim(
    outcomes: Outcomes,
    section: str,
    methods: Sequence[str],
    text: str,
    check: Callable[[], tuple[bool, str]],
) -> Claim:
    """Return a claim that is open where a method was not run."""
    if not outcomes.has(section, methods):
        return Claim(section, text, None, "not run")
    holds, figures = check()
    return Claim(section, text, holds, figures)


def _listed(
    outcomes: Outcomes, section: str, methods: Sequence[str], measure: Measure, digits: int = 2
) -> str:
    """Return the values of methods over the settings of a section, from the first to the last."""
    parts = []
    for method in methods:
        values = [measure(o) for o in outcomes.of(section, method)]
        parts.append(f"{method} " + ", ".join(f"{v:.{digits}f}" for v in values))
    return "; ".join(parts)


def _means(
    outcomes: Outcomes, section: str, methods: Sequence[str], measure: Measure, digits: int = 3
) -> str:
    means = ((m, outcomes.mean(section, m, measure)) for m in methods)
    return ", ".join(f"{m} {v:.{digits}f}" for m, v in means)


def _wins(
    outcomes: Outcomes, section: str, measure: Measure, *, most: bool, slack: float = 0.0
) -> tuple[int, int]:
    """Return in how many settings ElliFit is best of the thesis' methods, and of how many."""
    own = outcomes.of(section, "ellifit")
    wins = 0
    for k, outcome in enumerate(own):
        rest = [measure(outcomes.of(section, m)[k]) for m in _OTHERS]
        rest = [value for value in rest if not math.isnan(value)]
        value = measure(outcome)
        ahead = value + slack >= max(rest) if most else value - slack <= min(rest)
        wins += ahead
    return wins, len(own)


def _least_error(section: str, text: str, name: str) -> Callable[[Outcomes], Claim]:
    def check(outcomes: Outcomes) -> Claim:
        def measure(outcome: Outcome) -> float:
            return float(getattr(outcome, name))

        def judge() -> tuple[bool, str]:
            wins, total = _wins(outcomes, section, measure, most=False)
            means = _means(outcomes, section, THESIS_METHODS, measure)
            return wins == total, f"in {wins} of {total} settings; means {means}"

        label = "d" if name == "distance" else name.upper()
        return _claim(outcomes, section, THESIS_METHODS, text.format(label), judge)

    return check


def _all_but_135(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        rows = [o for o in outcomes.of("4.5.1", "ellifit") if o.setting.span >= 135]
        holds = all(detected(o) == 1 for o in rows if o.setting.span > 135)
        at = next((o for o in rows if o.setting.span == 135), None)
        told = f"at 135: detected {detected(at):.3f}, recall {recall(at):.3f}" if at else ""
        return holds, f"{told}; beyond: least {min(map(detected, rows)):.3f}"

    text = "ElliFit detects every ellipse of spans above 135 degrees (982 of 1,000 at 135)"
    return _claim(outcomes, "4.5.1", ("ellifit",), text, judge)


def _close_to_all(outcomes: Outcomes) -> Claim:
    methods = ("chaudhuri", "maini", "liu")

    def judge() -> tuple[bool, str]:
        holds = all(outcomes.mean("4.5.1", m, detected) > 0.95 for m in methods)
        holds &= all(outcomes.mean("4.5.1", m, recall) < 0.5 for m in methods)
        return holds, "recall by span: " + _listed(outcomes, "4.5.1", methods, recall)

    text = "Chaudhuri, Maini and Liu detect nearly all, with very poor recall and precision"
    return _claim(outcomes, "4.5.1", methods, text, judge)


def _harker_below(outcomes: Outcomes) -> Claim:
    methods = ("ellifit", "ahn", "harker")

    def judge() -> tuple[bool, str]:
        means = [outcomes.mean("4.5.1", m, recall) for m in methods]
        figures = "recall by span: " + _listed(outcomes, "4.5.1", methods, recall)
        return means[2] < min(means[:2]), figures

    text = "Harker has a poorer recall than ElliFit and Ahn"
    return _claim(outcomes, "4.5.1", methods, text, judge)


def _ahn_detects_fewer(outcomes: Outcomes) -> Claim:
    methods = ("ahn", "ellifit")

    def judge() -> tuple[bool, str]:
        means = [outcomes.mean("4.5.1", m, detected) for m in methods]
        return means[0] < means[1] - 0.02, _means(outcomes, "4.5.1", methods, detected)

    return _claim(outcomes, "4.5.1", methods, "Ahn detects far fewer ellipses than ElliFit", judge)


def _noise_least(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        means = {m: outcomes.mean("4.5.2", m, lambda o: o.distance) for m in THESIS_METHODS}
        ranked = sorted(means, key=lambda m: means[m])
        figures = ", ".join(f"{m} {means[m]:.2f}" for m in ranked)
        return set(ranked[:2]) == {"ahn", "ellifit"}, figures

    text = "Ahn and ElliFit have the lowest d (and E13) all round"
    return _claim(outcomes, "4.5.2", THESIS_METHODS, text, judge)


def _ahn_at_high_noise(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        pair = [
            [o.distance for o in outcomes.of("4.5.2", m, lambda o: o.setting.noise > 14)]
            for m in ("ahn", "ellifit")
        ]
        holds = all(a < e for a, e in zip(*pair, strict=True))
        return holds, f"Ahn {pair[0][-1]:.2f}, ElliFit {pair[1][-1]:.2f} px at the highest noise"

    text = "Above 14 % noise Ahn has a slightly lower d than ElliFit"
    return _claim(outcomes, "4.5.2", ("ahn", "ellifit"), text, judge)


def _third(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        means = {m: outcomes.mean("4.5.2", m, recall) for m in THESIS_METHODS}
        ranked = sorted(means, key=lambda m: -means[m])
        figures = "mean recall: " + ", ".join(f"{m} {means[m]:.3f}" for m in ranked)
        return ranked.index("chaudhuri") <= 2, figures

    text = "Chaudhuri is the third best with noise all round"
    return _claim(outcomes, "4.5.2", THESIS_METHODS, text, judge)


def _detections(section: str, text: str, outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        wins, total = _wins(outcomes, section, detected, most=True)
        last = {m: detected(outcomes.of(section, m)[-1]) for m in THESIS_METHODS}
        told = ", ".join(f"{m} {v:.3f}" for m, v in last.items())
        return wins == total, f"first or equal in {wins} of {total}; at the highest noise {told}"

    return _claim(outcomes, section, THESIS_METHODS, text, judge)


_most_detections = partial(_detections, "4.5.2", "ElliFit detects the most ellipses all round")
_sector_detections = partial(
    _detections, "4.5.2 sector", "ElliFit detects the most ellipses over 270 degrees"
)


def _recall_near_one(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        values = [recall(o) for o in outcomes.of("4.5.2", "ellifit")]
        figures = _listed(outcomes, "4.5.2", ("ellifit", "ahn"), recall)
        return min(values) >= 0.95, "recall by noise: " + figures

    text = "ElliFit's recall and precision are close to 1 at every noise"
    return _claim(outcomes, "4.5.2", ("ellifit", "ahn"), text, judge)


def _sector_ahn(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        section, methods = "4.5.2 sector", ("ahn", "ellifit")
        pairs = [outcomes.of(section, m, lambda o: o.setting.noise >= 14) for m in methods]
        holds = all(precision(a) > precision(e) for a, e in zip(*pairs, strict=True))
        return holds, "recall by noise: " + _listed(outcomes, section, methods, recall)

    text = "At high noise Ahn's detections are the more precise ones"
    return _claim(outcomes, "4.5.2 sector", ("ahn", "ellifit"), text, judge)


def _images_error(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        means = {m: outcomes.mean("4.5.3", m, lambda o: o.distance) for m in THESIS_METHODS}
        holds = min(means, key=lambda m: means[m]) == "ellifit"
        return holds, "d: " + ", ".join(f"{m} {v:.3f}" for m, v in means.items())

    text = "ElliFit has the lowest d (and E13) on edge curves"
    return _claim(outcomes, "4.5.3", THESIS_METHODS, text, judge)


def _images_total(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        rows = outcomes.of("4.5.3", "ellifit")
        shares = [o.counts.detected / o.counts.truths for o in rows]
        holds = all(0.9 <= share <= 1.25 for share in shares)
        return holds, "detections a true ellipse: " + ", ".join(f"{s:.2f}" for s in shares)

    text = "ElliFit detects about as many ellipses as there are (slightly more)"
    return _claim(outcomes, "4.5.3", ("ellifit",), text, judge)


def _images_recall(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        wins, total = _wins(outcomes, "4.5.3", recall, most=True)
        least = min(recall(o) for o in outcomes.of("4.5.3", "ellifit"))
        means = _means(outcomes, "4.5.3", THESIS_METHODS, recall)
        return wins == total and least > 0.95, f"highest in {wins} of {total}; means {means}"

    text = "ElliFit's recall is the highest and close to 1"
    return _claim(outcomes, "4.5.3", THESIS_METHODS, text, judge)


def _images_ahn(outcomes: Outcomes) -> Claim:
    methods = ("ahn", "ellifit", "harker")

    def judge() -> tuple[bool, str]:
        means = [outcomes.mean("4.5.3", m, precision) for m in methods]
        return means[0] > means[1], _means(outcomes, "4.5.3", methods, precision)

    text = "Ahn is slightly more precise than ElliFit"
    return _claim(outcomes, "4.5.3", methods, text, judge)


def _open(section: str, text: str, outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        means = {m: outcomes.mean(section, m, detected) for m in THESIS_METHODS}
        rest = [v for m, v in means.items() if m not in ("ellifit", "ahn")]
        holds = means["ellifit"] == 0 and means["ahn"] < 0.05 and min(rest) >= 0.55
        return holds, "mean share: " + ", ".join(f"{m} {v:.4f}" for m, v in means.items())

    return _claim(outcomes, section, THESIS_METHODS, text, judge)


_open_analytic = partial(
    _open, "4.5.4 analytic", "ElliFit detects none, Ahn a few, the others 60 to 100 %"
)
_open_digital = partial(
    _open, "4.5.4 digital", "ElliFit and Ahn detect none, the others 65 to 100 %"
)


def _fewest_false(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        wins, total = _wins(outcomes, "4.5.5", detected, most=False)
        means = _means(outcomes, "4.5.5", THESIS_METHODS, detected)
        return wins == total, f"in {wins} of {total} settings; means {means}"

    text = "ElliFit detects the fewest false ellipses at every noise and span"
    return _claim(outcomes, "4.5.5", THESIS_METHODS, text, judge)


def _false_share(outcomes: Outcomes, method: str, noise: float) -> float:
    rows = outcomes.of("4.5.5", method, lambda o: o.setting.noise == noise)
    trials = sum(o.trials for o in rows)
    return sum(o.counts.detected for o in rows) / trials if trials else math.nan


def _false_at_thirty(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        share = _false_share(outcomes, "ellifit", 30)
        return share <= 0.05, f"{100 * share:.2f} %"

    text = "At 30 % noise ElliFit detects 3.61 % false ellipses (taken as: at most 5 %)"
    return _claim(outcomes, "4.5.5", ("ellifit",), text, judge)


def _none_at_ninety(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        rows = outcomes.of("4.5.5", "ellifit", lambda o: o.setting.span == 180)
        shares = [detected(o) for o in rows]
        told = ", ".join(f"{s:.3f}" for s in shares)
        return max(shares, default=0.0) == 0, f"share by noise: {told}"

    text = "Of conics over +-90 degrees ElliFit detects none at any noise"
    return _claim(outcomes, "4.5.5", ("ellifit",), text, judge)


def _ahn_second(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        means = {m: outcomes.mean("4.5.5", m, detected) for m in THESIS_METHODS}
        ranked = sorted(means, key=lambda m: means[m])
        noises = sorted({o.setting.noise for o in outcomes.of("4.5.5", "ahn")})
        shares = [_false_share(outcomes, "ahn", noise) for noise in noises]
        told = ", ".join(f"{s:.3f}" for s in shares)
        return ranked[1] == "ahn" and shares[-1] > shares[0], f"Ahn's share by noise: {told}"

    text = "Ahn is second; its false ellipses grow quickly with the noise"
    return _claim(outcomes, "4.5.5", THESIS_METHODS, text, judge)


def _up_to_twenty(outcomes: Outcomes) -> Claim:
    def judge() -> tuple[bool, str]:
        rows = outcomes.of("4.5.2", "ellifit")
        worst, last = min(map(precision, rows)), rows[-1]
        best = max(recall(outcomes.of("4.5.2", m)[-1]) for m in _OTHERS)
        figures = f"at {last.setting.noise:g} %: recall {recall(last):.3f}, best other {best:.3f}"
        return worst >= 0.9 and recall(last) >= best, figures

    text = "ElliFit is superior with up to 20 % noise around ellipses"
    return replace(_claim(outcomes, "4.5.2", THESIS_METHODS, text, judge), section="4.6")
