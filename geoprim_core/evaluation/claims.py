"""Claims of the thesis beside what a rerun measured, and the Markdown that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim, where it stands, whether the rerun bears it out, and the figures.

    `holds` is None where the methods or curves for it are not there.
    """

    section: str
    text: str
    holds: bool | None
    figures: str

    @property
    def verdict(self) -> str:
        """The outcome in words."""
        return {True: "reproduced", False: "not reproduced", None: "not tried"}[self.holds]


def make_claim(section: str, text: str, holds: bool, figures: Sequence[str]) -> Claim:
    """Return a claim that is not tried where there are no figures.

    Examples
    --------
    >>> make_claim("3.6", "text", True, []).verdict
    'not tried'
    """
    return Claim(section, text, bool(holds) if figures else None, "; ".join(figures) or "no rows")


def grid_lines(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> list[str]:
    """Return a Markdown table and an empty line.

    Examples
    --------
    >>> grid_lines(["a", "b"], [(1, 2)])
    ['| a | b |', '|---|---|', '| 1 | 2 |', '']
    """
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return [*lines, *("| " + " | ".join(map(str, row)) + " |" for row in rows), ""]


def claim_lines(claims: Sequence[Claim]) -> list[str]:
    """Return the section on claims of a report.

    Examples
    --------
    >>> claim_lines([])[0]
    '## Claims'
    """
    rows = [(claim.section, claim.text, claim.verdict, claim.figures) for claim in claims]
    return ["## Claims", "", *grid_lines(("section", "claim", "result", "figures"), rows)]


def claim_text(claim: Claim) -> str:
    """Return a claim as one line for the terminal.

    Examples
    --------
    >>> claim_text(Claim("2.7", "N falls", False, "3, 4"))
    '2.7      NOT reproduced  N falls: 3, 4'
    """
    verdict = claim.verdict.replace("not reproduced", "NOT reproduced")
    return f"{claim.section:8} {verdict:15} {claim.text}: {claim.figures}"
