"""All experiments of thesis chapter 3 in one run, spread over the processors."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import astuple, dataclass, fields
from typing import Any

from geoprim_core._check import FloatArray
from geoprim_core.evaluation.reproduce_tangent import (
    SIZES,
    Task,
    best_controls,
    entrants_of,
    family_tasks,
    grid_tasks,
    sweep_tasks,
)
from geoprim_core.evaluation.reproduce_tangent_bounds import (
    BoundRow,
    Sensitivity,
    bound_rows,
    sensitivities,
)
from geoprim_core.evaluation.reproduce_tangent_walk import WalkRow, walk_rows
from geoprim_core.evaluation.tangent_errors import Row, errors_by_direction
from geoprim_core.tangent import TABLE


@dataclass(frozen=True, slots=True)
class Results:
    """What a run measured.

    Attributes
    ----------
    sensitivity : Yuen's centre, 3.2.2
    bounds, walks : DEB on conics, 3.5, and along pixels
    sweep : every R and Q on each family, on curves of their own
    controls : (family, method) -> the R or Q of the least mean error in the sweep
    rows : every entrant on every setting of each family, 3.6.3 to 3.6.5
    grid : the same on finer and finer grids
    directions : label -> mean error on circles in 72 sectors of the direction
    """

    sensitivity: list[Sensitivity]
    bounds: list[BoundRow]
    walks: list[WalkRow]
    sweep: list[Row]
    controls: dict[tuple[str, str], float]
    rows: list[Row]
    grid: list[Row]
    directions: dict[str, FloatArray]


@dataclass(frozen=True, slots=True)
class Extent:
    """How much a run measures: curves a setting, conics a family, curves a grid, sizes, methods."""

    count: int = 100
    conics: int = 200
    grid: int = 10
    sizes: tuple[int, ...] = SIZES
    methods: tuple[str, ...] = TABLE.names

    @classmethod
    def of(cls, count: int, methods: Sequence[str] = TABLE.names) -> Extent:
        """Return the extent of a run with `count` curves a setting; the rest shrinks with it.

        DEB is always among the methods.

        Raises
        ------
        ParameterError
            A method is unknown.

        Examples
        --------
        >>> Extent.of(100) == Extent(), Extent.of(2).sizes
        (True, (25, 50, 100))
        """
        names = tuple(TABLE[name].name for name in dict.fromkeys(("deb", *methods)))
        sizes = SIZES if count >= 10 else SIZES[:3]
        return cls(count, max(2 * count, 4), max(count // 10, 1), sizes, names)


def run_experiments(
    extent: Extent, seed: int, *, workers: int | None = None, step: Callable[[], object] = int
) -> Results:
    """Run every experiment; the results do not depend on the number of workers.

    Parameters
    ----------
    extent : Extent
    seed : int
    workers : int, optional
        Processes; default: one a processor. 1 stays in this process.
    step : function
        Called after each task, `task_count` times in all.

    Examples
    --------
    >>> task_count(Extent.of(1)) > 100
    True
    """
    names = extent.methods
    sweep = _measured(list(sweep_tasks(min(extent.count, 20), seed, names)), workers, step)
    controls = best_controls(sweep)
    rows = _measured(list(family_tasks(controls, extent.count, seed, names)), workers, step)
    grid = _measured(list(grid_tasks(extent.grid, seed, extent.sizes, names)), workers, step)
    found = Results(
        sensitivities(),
        list(bound_rows(extent.conics)),
        walk_rows(seed, extent.grid),
        sweep,
        controls,
        rows,
        grid,
        errors_by_direction(entrants_of("circle", controls, names), extent.count, seed),
    )
    step()
    return found


def task_count(extent: Extent) -> int:
    """Return how often `run_experiments` calls its step."""
    tasks = (sweep_tasks(1, 0), family_tasks({}, 1, 0), grid_tasks(1, 0, extent.sizes))
    return sum(len(list(each)) for each in tasks) + 1


def _measured(tasks: Sequence[Task], workers: int | None, step: Callable[[], object]) -> list[Row]:
    count = min(workers or os.cpu_count() or 1, len(tasks))
    if count == 1:
        return _collected(map(_rows_of, tasks), step)
    with ProcessPoolExecutor(count) as pool:
        return _collected(pool.map(_rows_of, tasks), step)


def _rows_of(task: Task) -> list[Row]:
    return task.rows()


def _collected(parts: Iterable[list[Row]], step: Callable[[], object]) -> list[Row]:
    rows = []
    for part in parts:
        rows += part
        step()
    return rows


def records_csv(records: Sequence[Any]) -> str:
    """Return dataclass records of one kind as CSV, numbers in full.

    Examples
    --------
    >>> records_csv([Row("circle", 0.0, "deb(10)", 1.0, 2.0, 3.0, 1.0)]).splitlines()[1]
    'circle,0.0,deb(10),1.0,2.0,3.0,1.0'
    """
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    if records:
        table.writerow([field.name for field in fields(records[0])])
    table.writerows(astuple(record) for record in records)
    return file.getvalue()


def sensitivity_csv(results: Results) -> str:
    """Return mean and largest relative error of Yuen's centre, one row a test and size.

    Examples
    --------
    >>> sensitivity_csv(Results([], [], [], [], {}, [], [], {})).strip()
    'test,digitised,semi_major,mean,maximum'
    """
    lines = ["test,digitised,semi_major,mean,maximum"]
    for each in results.sensitivity:
        head = f"{each.test},{each.digitised},{each.semi_major:g}"
        lines.append(f"{head},{each.mean:.6g},{each.maximum:.6g}")
    return "\n".join(lines) + "\n"


def directions_csv(results: Results) -> str:
    """Return the mean errors on circles, one row a sector and one column a method.

    Examples
    --------
    >>> directions_csv(Results([], [], [], [], {}, [], [], {})).strip()
    'degrees'
    """
    lines = [",".join(["degrees", *results.directions])]
    lines += _sector_lines(list(results.directions.values()))
    return "\n".join(lines) + "\n"


def _sector_lines(columns: list[FloatArray]) -> Iterator[str]:
    for k in range(len(columns[0]) if columns else 0):
        middle = 360.0 / len(columns[0]) * (k + 0.5)
        yield ",".join([f"{middle:g}", *(f"{column[k]:.6g}" for column in columns)])
