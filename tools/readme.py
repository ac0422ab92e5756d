"""Writes the generated tables of README.md and docs/ from the code; `--check` only compares.

A table stands between `<!-- table: NAME -->` and `<!-- end -->`. What was measured stands between
`<!-- measured: geoprim COMMAND -->` and `<!-- end -->`: `--measure` runs the command, which takes
minutes and a quiet machine, and puts in what it prints.
"""

from __future__ import annotations

import argparse
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterable
from itertools import chain, groupby
from pathlib import Path

_MANY = 20  # so many rows or choices are told by the first and the last

ROOT = Path(__file__).resolve().parent.parent
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
MEASURED = re.compile(r"(<!-- measured: geoprim ([^\n]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def methods() -> str:
    """Return the table of every method: family, name, function, parameters, citation."""
    from geoprim_core import ecc, edges, fitting, polygon, tangent

    families = {
        "edge linking": edges.TABLE,
        "polygonal approximation": polygon.TABLE,
        "tangents": tangent.TABLE,
        "ellipse fitting": fitting.TABLE,
        "ellipse detection": ecc.TABLE,
    }
    rows = [
        (
            family,
            f"`{row.name}`",
            f"`{_path(row.function)}`",
            f"`{row.params.__name__}`",
            row.citation,
        )
        for family, table in families.items()
        for row in table
    ]
    head = ("family", "name", "function", "parameters", "source")
    return table_of(head, chain.from_iterable(_as_one(a) for _, a in groupby(rows, key=_kind)))


def _kind(row: tuple[str, ...]) -> tuple[str, ...]:
    """Return what rows of methods made in one go have in common: all but the name."""
    family, _, function, params, source = row
    return family, function.rpartition(".")[0], params, source


def _as_one(alike: Iterable[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Return one row for the methods made in one go, as the hybrid ones are; few stay apart."""
    rows = list(alike)
    if len(rows) < _MANY:
        return rows
    family, name, function, params, source = rows[0]
    names = f"{name} .. {rows[-1][1]} ({len(rows)})"
    return [(family, names, f"{function} ..", params, source)]


def _path(function: Callable[..., object]) -> str:
    return f"{function.__module__.removeprefix('geoprim_core.')}.{function.__qualname__}"


def parameters() -> str:
    """Return the table of every parameter of the chain."""
    from geoprim_core.ecc import DetectorParams

    rows = []
    for o in DetectorParams.options():
        if o.choices:
            values = ", ".join(o.choices)
            if len(o.choices) >= _MANY:
                values = f"{', '.join(o.choices[:3])} .. {o.choices[-1]} ({len(o.choices)} names)"
        elif o.kind is bool:
            values = "true, false"
        else:
            values = f"{'' if o.low is None else o.low} .. {'' if o.high is None else o.high}"
        rows.append((f"`{o.name}`", f"`{o.default}`", o.unit, values, o.text))
    return table_of(("parameter", "default", "unit", "values", "meaning"), rows)


def topics() -> str:
    """Return the table of the topics of every node."""
    from geoprim_ros.topics import TOPICS

    rows = [(f"`{t.name}`", f"`{t.type}`", t.published_by, t.text) for t in TOPICS]
    return table_of(("topic", "type", "published by", "holds"), rows)


def messages() -> str:
    """Return the table of every field of our messages."""
    rows = []
    for file in sorted((ROOT / "msg_defs" / "geoprim_msgs" / "msg").glob("*.msg")):
        for line in file.read_text().splitlines():
            field = re.match(r"(\S+)\s+(\w+)\s+#\s*(.+)", line)
            if field and not line.startswith("#"):
                kind, name, text = field.groups()
                rows.append((f"`{file.stem}`", f"`{kind}`", f"`{name}`", text))
    return table_of(("message", "type", "field", "meaning [unit]"), rows)


def table_of(head: tuple[str, ...], rows: Iterable[tuple[object, ...]]) -> str:
    """Return a Markdown table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


TABLES = {"methods": methods, "parameters": parameters, "topics": topics, "messages": messages}


def filled(text: str) -> str:
    """Return the text with every table made anew."""
    return BLOCK.sub(lambda m: f"{m[1]}{TABLES[m[2]]()}\n{m[3]}", text)


def measured(command: str) -> str:
    """Return what a command of geoprim prints."""
    words = [sys.executable, "-m", "geoprim_core.cli.main", *shlex.split(command)]
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def main() -> int:
    """Write the pages, or with --check tell which are not up to date."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="only compare, exit code 1 if stale")
    parser.add_argument("--measure", action="store_true", help="measure anew too")
    arguments = parser.parse_args()
    texts = {page: page.read_text() for page in PAGES}
    made = {page: filled(text) for page, text in texts.items()}
    if arguments.measure:
        made = {
            page: MEASURED.sub(lambda m: f"{m[1]}{measured(m[2])}{m[3]}", text)
            for page, text in made.items()
        }
    stale = {page: text for page, text in made.items() if text != texts[page]}
    for page, new in stale.items():
        if arguments.check:
            print(f"{page.name}: its tables are stale; run ./run exec python tools/readme.py")
        else:
            page.write_text(new)
    return int(arguments.check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
