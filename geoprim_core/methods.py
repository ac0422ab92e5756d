"""Method tables: each family of methods is one hand-written table of rows."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from geoprim_core._check import describe, with_article
from geoprim_core.errors import ParameterError
from geoprim_core.params import Params


@dataclass(frozen=True)
class Method:
    """One row: published short name, function, Params class and citation."""

    name: str
    function: Callable[..., Any]
    params: type[Params]
    citation: str


class Table:
    """The rows of one family, iterable in their written order and indexed by name."""

    def __init__(self, family: str, *rows: Method) -> None:
        self.family = family
        self._rows = {row.name: row for row in rows}

    def __iter__(self) -> Iterator[Method]:
        return iter(self._rows.values())

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, name: str) -> Method:
        """Return the row of a name; an unknown one raises `ParameterError` with the nearest."""
        try:
            return self._rows[name]
        except (KeyError, TypeError):
            near = difflib.get_close_matches(str(name).lower(), self._rows, 1)
            hint = f" (did you mean {near[0]!r}?)" if near else ""
            noun = with_article(f"{self.family} method")
            expected = f"{noun}{hint}, one of {', '.join(self.names)}"
            raise ParameterError("method", expected, describe(name)) from None

    @property
    def names(self) -> tuple[str, ...]:
        """The short names of all rows."""
        return tuple(self._rows)
