"""The tables and the picture of the measurement."""

from __future__ import annotations

import csv
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geoprim_core.plotting import plot_latencies
from geoprim_ros.bench.cases import GRAPHS, Case
from geoprim_ros.bench.runs import OTHERS, Run, highest_clean

HEAD = (
    "images", "graph", "Fast DDS profile", "frames/s", "received", "dropped", "p50 ms", "p95 ms",
    "CPU %", "highest frames/s without a drop",
)  # fmt: skip
_ALIGNED = ("---", "---", "---", *("---:",) * 5, "---", "---:")


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """A case and its runs; the first is the one that the table shows."""

    case: Case
    runs: tuple[Run, ...]


def markdown(measured: Sequence[Measured]) -> str:
    """Return the table, one row a case, and what it was measured on."""
    rows = [HEAD, _ALIGNED, *(_row(one) for one in measured)]
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    graphs = dict.fromkeys(one.case.graph.name for one in measured)
    told = "; ".join(f"{name}: {GRAPHS[name].text}" for name in graphs)
    beside = [run.cpu[OTHERS] for one in measured for run in one.runs]
    cores = f"{os.cpu_count()} cores, Python {platform.python_version()}"
    other = f"what ran beside took {min(beside):.0f} to {max(beside):.0f} % of a core"
    return "\n".join([*lines, "", f"{told}. {cores}; {other}."]) + "\n"


def _row(one: Measured) -> tuple[object, ...]:
    shown = one.runs[0]
    return (
        one.case.pictures.name, one.case.graph.name, one.case.profile, f"{shown.rate:g}",
        f"{shown.received} of {shown.sent}", shown.dropped, f"{shown.percentile_ms(50):.1f}",
        f"{shown.percentile_ms(95):.1f}", _cpu(shown.cpu),
        _highest(one.runs),
    )  # fmt: skip


def _highest(runs: Sequence[Run]) -> str:
    highest = highest_clean(runs)
    if not highest:
        return "none of these" if len(runs) > 1 else "less"
    searched = any(run.rate > highest for run in runs)
    return f"{highest:g}" if searched else f"{highest:g} or more"


def _cpu(cpu: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {share:.0f}" for name, share in cpu.items() if name != OTHERS)


def write_csv(measured: Sequence[Measured], path: Path) -> None:
    """Write one row a run."""
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            ["images", "graph", "modules", "profile", "rate", "sent_rate", "sent", "received",
             "dropped", "p50_ms", "p95_ms", "p99_ms", "cpu_percent", "others_percent"]
        )  # fmt: skip
        for one in measured:
            case = one.case
            start = [case.pictures.name, case.graph.name, len(case.graph.modules), case.profile]
            for run in one.runs:
                times = [f"{run.percentile_ms(p):.3f}" for p in (50, 95, 99)]
                table.writerow(
                    [*start, run.rate, f"{run.sent_rate:.2f}", run.sent, run.received, run.dropped,
                     *times, _cpu(run.cpu), f"{run.cpu[OTHERS]:.0f}"]
                )  # fmt: skip


def write_plot(measured: Sequence[Measured], path: Path) -> None:
    """Write the distribution of the latencies, one panel a kind of images."""
    draw_panels(measured).savefig(path, dpi=130)


def draw_panels(measured: Sequence[Measured]) -> Any:
    """Return a figure of one panel a kind of images, the runs of the table in it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(one.case.pictures.name for one in measured))
    figure = Figure(figsize=(5.5 * len(names), 5.8), layout="constrained")
    FigureCanvasAgg(figure)
    for ax, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        here = [one for one in measured if one.case.pictures.name == name]
        times = {_label(one): one.runs[0].latencies_ms for one in here}
        sent = {_label(one): one.runs[0].sent for one in here}
        plot_latencies(times, ax, sent=sent, title=f"{name}, {here[0].runs[0].rate:g} frames/s")
    return figure


def _label(one: Measured) -> str:
    dropped = one.runs[0].dropped
    return f"{one.case.graph.name}, {one.case.profile}" + (
        f", {dropped} dropped" if dropped else ""
    )
