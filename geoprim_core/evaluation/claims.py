"""Claims of the thesis, checked on the rows of a rerun, and Markdown tables for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim, where it stands, whether the rerun bears it out, and the figures.

    `holds` is None where the methods or settings for it were not run.
    """

    section: str
    text: str
    holds: bool | None
    figures: str

    @property
    def verdict(self) -> str:
        """The word for the outcome.

        Examples
        --------
        >>> Claim("4.5.1", "it works", None, "").verdict
        'not tried'
        """
        return {True: "reproduced", False: "not reproduced", None: "not tried"}[self.holds]


def markdown_grid(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> list[str]:
    """Return the lines of a Markdown table and an empty one.

    Examples
    --------
    >>> markdown_grid(["a", "b"], [[1, 2]])
    ['| a | b |', '|---|---|', '| 1 | 2 |', '']
    """
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return [*lines, *("| " + " | ".join(map(str, row)) + " |" for row in rows), ""]


def claim_lines(claims: Sequence[Claim]) -> list[str]:
    """Return the section of a report that lists claims."""
    rows = [(c.section, c.text, c.verdict, c.figures) for c in claims]
    return ["## Claims", "", *markdown_grid(("section", "claim", "result", "figures"), rows)]
