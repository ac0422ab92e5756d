"""What is measured: the graphs, the images, and with which Fast DDS profile."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from geoprim_core.errors import InputError


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """A graph from images to ellipses.

    Attributes
    ----------
    name, text : str
    modules : tuple of str
        Every one runs in a process of its own.
    """

    name: str
    text: str
    modules: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """The images of a case.

    Attributes
    ----------
    size : (width, height) in pixels
    transport : "raw" (bgr8) or "compressed" (JPEG)
    count : int
        So many different ones, sent in turn.
    first_rate : float
        The rate of the row that is shown.
    rates : tuple of float
        The rates that the highest one is looked for among.
    """

    size: tuple[int, int]
    transport: str
    count: int
    first_rate: float
    rates: tuple[float, ...]

    @property
    def name(self) -> str:
        """Size and format, as the tables show them."""
        width, height = self.size
        return f"{width}x{height} {'bgr8' if self.transport == 'raw' else 'JPEG'}"


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One graph on one kind of images, with the Fast DDS profile of ours or the stock one."""

    graph: Graph
    pictures: Pictures
    own_profile: bool

    @property
    def profile(self) -> str:
        """The profile's name in the tables."""
        return "ours" if self.own_profile else "stock"


_NODES = "geoprim_ros.nodes."
_STAGES = ("edges_node", "polygons_node", "ellipses_node")
GRAPHS = {
    graph.name: graph
    for graph in (
        Graph("separate", "three processes", tuple(_NODES + name for name in _STAGES)),
        Graph("composed", "three nodes, one process", (_NODES + "pipeline",)),
        Graph("one callback", "`detector_node`", (_NODES + "detector_node",)),
        Graph("empty", "a node that only reads", ("geoprim_ros.bench.reader",)),
    )
}

_SMALL_RATES = (5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 60, 80, 100, 150, 200)
_LARGE_RATES = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30, 40, 60, 80)
_SIZES = {
    "640x480": Pictures((640, 480), "raw", 60, 30, _SMALL_RATES),
    "1920x1080": Pictures((1920, 1080), "raw", 12, 3, _LARGE_RATES),
}
SIZES = tuple(_SIZES)


def cases_of(
    graphs: Sequence[str], sizes: Sequence[str], *, compressed: bool, stock: bool
) -> Iterator[Case]:
    """Yield the cases: every graph on every size; compressed images only with our profile.

    Parameters
    ----------
    graphs : names in GRAPHS
    sizes : of SIZES
    compressed : also JPEG
    stock : also without our Fast DDS profile

    Raises
    ------
    InputError
        A name is not known.
    """
    for name in graphs:
        if name not in GRAPHS:
            raise InputError("--graphs", f"of {', '.join(GRAPHS)}", repr(name))
    for size in sizes:
        if size not in _SIZES:
            raise InputError("--sizes", f"of {', '.join(SIZES)}", repr(size))
        raw = _SIZES[size]
        for own in (True, False) if stock else (True,):
            yield from (Case(GRAPHS[name], raw, own) for name in graphs)
        if compressed:
            small = Pictures(raw.size, "compressed", raw.count, raw.first_rate, raw.rates)
            yield from (Case(GRAPHS[name], small, True) for name in graphs)
