"""The report of `geoprim reproduce fitting`: claims, best methods, the chooser, tables."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

from geoprim_core.evaluation.claims import Claim, claim_lines, grid_lines
from geoprim_core.evaluation.reproduce_fitting import COLUMNS, SECTIONS, Outcome, Setting
from geoprim_core.evaluation.reproduce_fitting_outcomes import (
    Measure,
    Outcomes,
    detected,
    precision,
    recall,
)

TIED = 0.005
"""A share that is no more than this behind the best one is tied with it: 5 of 1,000 trials."""

SELECTIVE = 0.1
"""A method with at most this share of false ellipses on open conics is called selective."""

_MOST_NAMES = 4


@dataclass(frozen=True, slots=True)
class Best:
    """The best of ours against the best peer in one setting.

    `own` and `peer` are shares of found truths, or of false ellipses on open conics.
    """

    setting: Setting
    own: float
    methods: tuple[str, ...]
    peer: float
    peers: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """The word for the comparison: best, tied (within `TIED`) or behind."""
        ahead = self.peer - self.own if self.setting.open else self.own - self.peer
        if ahead > TIED:
            return "best"
        return "tied" if ahead >= -TIED - 1e-12 else "behind"


def best_rows(outcomes: Outcomes, own: Sequence[str], peers: Sequence[str]) -> list[Best]:
    """Return who is best of ours and of the peers in every setting.

    Examples
    --------
    >>> best_rows(Outcomes([]), ["nsaf"], [])
    []
    """
    settings = list(dict.fromkeys(o.setting for o in outcomes.all))
    found = []
    for setting in settings:
        rows = [o for o in outcomes.all if o.setting == setting]
        ours = _leaders([o for o in rows if o.method in own])
        theirs = _leaders([o for o in rows if o.method in peers])
        found.append(Best(setting, *ours, *theirs))
    return found


def _score(outcome: Outcome) -> float:
    return detected(outcome) if outcome.setting.open else recall(outcome)


def _leaders(rows: Sequence[Outcome]) -> tuple[float, tuple[str, ...]]:
    """Return the best score and the methods that are tied with it."""
    if not rows:
        return math.nan, ()
    best = min(map(_score, rows)) if rows[0].setting.open else max(map(_score, rows))
    return best, tuple(o.method for o in rows if abs(_score(o) - best) <= TIED + 1e-12)


def universal_methods(outcomes: Outcomes, own: Sequence[str], best: Sequence[Best]) -> list[str]:
    """Return, by method of ours, in how many settings it is at least tied with the best peer.

    Examples
    --------
    >>> universal_methods(Outcomes([]), ["nsaf"], [])
    ['nsaf 0 of 0']
    """
    scores = {(o.setting, o.method): _score(o) for o in outcomes.all}
    lines = []
    for method in own:
        wins = 0
        for row in best:
            value = scores[row.setting, method]
            behind = value - row.peer if row.setting.open else row.peer - value
            wins += behind <= TIED + 1e-12
        lines.append(f"{method} {wins} of {len(best)}")
    return sorted(lines, key=lambda line: -int(line.split()[1]))


_SITUATIONS = (
    ("edge pixels, up to about a quarter", "4.5.1", (0, 112.5), (0, 100)),
    ("edge pixels, 135 to 180 degrees", "4.5.1", (113, 180), (0, 100)),
    ("edge pixels, more than 180 degrees", "4.5.1", (181, 360), (0, 100)),
    ("scattered points, 120 to 150 degrees, noise 1 - 2 %", "noisy arcs", (120, 150), (1, 2)),
    ("scattered points, 120 to 150 degrees, noise 4 - 8 %", "noisy arcs", (120, 150), (4, 8)),
    ("scattered points, 180 to 225 degrees, noise 1 - 2 %", "noisy arcs", (180, 225), (1, 2)),
    ("scattered points, 180 to 225 degrees, noise 4 - 8 %", "noisy arcs", (180, 225), (4, 8)),
    ("scattered points, 270 degrees, noise up to 8 %", "4.5.2 sector", (0, 360), (0, 8)),
    ("scattered points, 270 degrees, noise 10 - 20 %", "4.5.2 sector", (0, 360), (10, 20)),
    ("scattered points, all round, noise up to 8 %", "4.5.2", (0, 360), (0, 8)),
    ("scattered points, all round, noise 10 - 20 %", "4.5.2", (0, 360), (10, 20)),
    ("smooth edge curves of an image", "4.5.3", (0, 360), (0, 100)),
)


def chooser_lines(outcomes: Outcomes, own: Sequence[str]) -> list[str]:
    """Return the table that tells which method to use when, as lines of Markdown.

    Examples
    --------
    >>> chooser_lines(Outcomes([]), [])[0][:11]
    '| situation'
    """
    false = {method: false_share(outcomes, method) for method in own}
    selective = [method for method in own if false[method] <= SELECTIVE]
    rows = []
    for text, section, spans, noises in _SITUATIONS:
        scores = {m: _situation(outcomes, section, m, spans, noises) for m in own}
        known = {m: s for m, s in scores.items() if not math.isnan(s)}
        if known:
            rows.append((text, _ranked(known), _ranked({m: known[m] for m in selective})))
    told = sorted((m for m in own if not math.isnan(false[m])), key=lambda m: false[m])
    if told:
        listed = ", ".join(f"{m} {100 * false[m]:.1f} %" for m in told)
        rows.append(("the points may be of no ellipse: false ellipses", listed, ""))
    heads = ("situation", "best: found at an overlap of 0.8", "best of the selective ones")
    return grid_lines(heads, rows)


def false_share(outcomes: Outcomes, method: str) -> float:
    """Return the share of false ellipses of a method, a mean over the sections of open conics."""
    sections = [s for s in outcomes.sections() if s.startswith(("4.5.4", "4.5.5"))]
    shares = [outcomes.mean(section, method, detected) for section in sections]
    return sum(shares) / len(shares) if shares else math.nan


def _situation(
    outcomes: Outcomes,
    section: str,
    method: str,
    spans: tuple[float, float],
    noises: tuple[float, float],
) -> float:
    rows = outcomes.of(
        section,
        method,
        lambda o: (
            spans[0] <= o.setting.span <= spans[1] and noises[0] <= o.setting.noise <= noises[1]
        ),
    )
    return sum(map(recall, rows)) / len(rows) if rows else math.nan


def _ranked(scores: dict[str, float]) -> str:
    """Return the methods within 1 per cent of the best, best first, with their shares."""
    best = max(scores.values(), default=0.0)
    near = sorted((m for m, s in scores.items() if s >= best - 0.01), key=lambda m: -scores[m])
    told = ", ".join(f"{m} {100 * scores[m]:.1f} %" for m in near[:_MOST_NAMES])
    return told + (f" and {len(near) - _MOST_NAMES} more" if len(near) > _MOST_NAMES else "")


def rows_csv(outcomes: Sequence[Outcome]) -> str:
    """Return the outcomes as CSV.

    Examples
    --------
    >>> rows_csv([]).startswith("section,span,noise,ellipses,method,trials,curves,truths,detected")
    True
    """
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(COLUMNS)
    table.writerows(outcome.cells() for outcome in outcomes)
    return file.getvalue()


def report_markdown(
    outcomes: Outcomes, claims: Sequence[Claim], own: Sequence[str], peers: Sequence[str]
) -> str:
    """Return the whole report as Markdown.

    Examples
    --------
    >>> report_markdown(Outcomes([]), [], [], []).splitlines()[0]
    '# Ellipse fits: section 4.5 rerun'
    """
    lines = ["# Ellipse fits: section 4.5 rerun", ""]
    lines += [f"Ours: {', '.join(own)}. Peers: {', '.join(peers) or 'none installed'}.", ""]
    lines += claim_lines(claims)
    lines += ["## Which to use when", "", *chooser_lines(outcomes, own)]
    lines += _best_lines(outcomes, own, peers)
    for section in outcomes.sections():
        lines += _section_lines(outcomes, section)
    return "\n".join(lines) + "\n"


def _best_lines(outcomes: Outcomes, own: Sequence[str], peers: Sequence[str]) -> list[str]:
    if not peers:
        return []
    best = best_rows(outcomes, own, peers)
    lines = ["## Ours against the peers", ""]
    counts = {word: sum(b.verdict == word for b in best) for word in ("best", "tied", "behind")}
    lines += [
        "Share of the truths found at an overlap of 0.8; of open conics the share of false "
        f"ellipses. Tied: within {100 * TIED:g} points. "
        + ", ".join(f"{word} in {n}" for word, n in counts.items())
        + f" of {len(best)} settings.",
        "",
        "Settings where a method is at least tied with the best peer: "
        + "; ".join(universal_methods(outcomes, own, best))
        + ".",
        "",
    ]
    rows = [
        (
            *_setting_cells(row.setting),
            f"{100 * row.own:.1f} %",
            ", ".join(row.methods),
            f"{100 * row.peer:.1f} %",
            ", ".join(row.peers),
            row.verdict,
        )
        for row in best
    ]
    heads = ("section", "setting", "ours", "methods", "peer", "peers", "result")
    return lines + grid_lines(heads, rows)


def _setting_cells(setting: Setting) -> tuple[str, str]:
    if setting.section == "4.5.3":
        return setting.section, f"{setting.ellipses} ellipses"
    noise = f", {setting.noise:g} %" if setting.noise else ""
    return setting.section, f"{setting.span:g} deg{noise}"


def _section_lines(outcomes: Outcomes, section: str) -> list[str]:
    """Return the tables of one experiment: a row a method, a column a setting."""
    lines = [f"## {section}: {SECTIONS[section]}", ""]
    methods = outcomes.methods()
    rows = outcomes.of(section, methods[0])
    trials = sorted({o.trials for o in outcomes.all if o.setting.section == section})
    lines += ["Trials a setting: " + ", ".join(map(str, trials)) + ".", ""]
    heads = ["method", *(_setting_cells(o.setting)[1] for o in rows)]
    if rows[0].setting.open:
        return lines + _grid_of(outcomes, section, heads, ("false ellipses", detected))
    lines += _grid_of(outcomes, section, heads, ("detections a trial", detected))
    lines += _grid_of(outcomes, section, heads, ("recall", recall))
    lines += _grid_of(outcomes, section, heads, ("precision", precision))
    for name in ("e13", "e14", "distance"):
        lines += _grid_of(outcomes, section, heads, (f"mean {name} [px]", _field(name)))
        if section == "4.5.3":
            spread = _field(f"{name}_spread")
            lines += _grid_of(outcomes, section, heads, (f"deviation of {name} [px]", spread))
    return lines


def _field(name: str) -> Measure:
    return lambda outcome: float(getattr(outcome, name))


def _grid_of(
    outcomes: Outcomes, section: str, heads: Sequence[str], titled: tuple[str, Measure]
) -> list[str]:
    title, of = titled
    rows = []
    for method in outcomes.methods():
        values = [of(o) for o in outcomes.of(section, method)]
        rows.append((method, *("" if math.isnan(v) else f"{v:.3f}" for v in values)))
    return [f"**{title}**", "", *grid_lines(heads, rows)]
