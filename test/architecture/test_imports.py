"""The house as its design says: which room may import which, and which library stays where."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "geoprim_core"
# digital: straight segments, on which methods of the rooms polygon and tangent both stand.
FOUNDATIONS = {"types", "params", "methods", "errors", "digital", "_check", "_jit", "__init__"}
METHOD_ROOMS = {"edges", "polygon", "tangent", "fitting"}

# Room -> rooms it may import, beside itself and the foundations.
ALLOWED = {
    "digital": set(),
    "edges": set(),
    "polygon": set(),
    "tangent": set(),
    "fitting": set(),
    "ecc": METHOD_ROOMS,
    "applications": METHOD_ROOMS | {"ecc"},
    "synthetic": {"fitting"},
    "evaluation": METHOD_ROOMS | {"ecc", "synthetic"},
    "io": METHOD_ROOMS | {"ecc", "applications", "synthetic", "evaluation", "warm"},
    "plotting": METHOD_ROOMS | {"ecc", "applications", "evaluation", "io", "synthetic"},
    "warm": METHOD_ROOMS | {"ecc", "synthetic"},
    "cli": METHOD_ROOMS
    | {"ecc", "applications", "evaluation", "io", "plotting", "synthetic", "warm"},
}


def modules(folder):
    return sorted(p for p in folder.rglob("*.py") if "__pycache__" not in p.parts)


def imported(path, *, top_level=False):
    """Yield every dotted module name that a file imports."""
    tree = ast.parse(path.read_text())
    typing_only = {
        node
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for node in ast.walk(block)
    }
    nodes = tree.body if top_level else ast.walk(tree)
    for node in nodes:
        if node in typing_only:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def room_of(path):
    first = path.relative_to(CORE).parts[0]
    return first.removesuffix(".py")


def names(paths):
    return [str(p.relative_to(ROOT)) for p in paths]


CORE_FILES = modules(CORE)
ROS_FILES = modules(ROOT / "geoprim_ros")


@pytest.mark.parametrize("path", CORE_FILES, ids=names(CORE_FILES))
def test_rooms_import_only_what_lies_upstream(path):
    room = room_of(path)
    allowed = FOUNDATIONS | {room} | ALLOWED.get(room, set())
    for name in imported(path):
        parts = name.split(".")
        if parts[0] == "geoprim_core" and len(parts) > 1 and not parts[1].startswith("__"):
            assert parts[1] in allowed, f"{room} must not import {name}"
        assert parts[0] != "geoprim_ros", "the core knows nothing of ROS nodes"


@pytest.mark.parametrize("path", CORE_FILES, ids=names(CORE_FILES))
def test_libraries_stay_in_their_rooms(path):
    room = room_of(path)
    for name in imported(path):
        library = name.split(".")[0]
        assert library not in {"rclpy", "geoprim_msgs", "sensor_msgs", "std_msgs"}
        assert library != "cv2" or room in {"edges", "io"}, "cv2 belongs to edges/ and io/"
        assert library != "numba" or path.name == "_jit.py", "_jit is the one door to numba"
    for name in imported(path, top_level=True):
        assert name.split(".")[0] != "matplotlib", "matplotlib is imported where it plots"


@pytest.mark.parametrize("path", ROS_FILES, ids=names(ROS_FILES))
def test_nodes_leave_numerics_to_the_core(path):
    libraries = {name.split(".")[0] for name in imported(path)}
    assert not libraries & {"cv2", "numba", "scipy"}


def test_kernels_live_in_kernel_files():
    for path in CORE_FILES:
        if not path.name.startswith("_kernels") and path.name != "_jit.py":
            assert "@kernel" not in path.read_text(), f"{path}: kernels live in _kernels*.py"


def test_modules_stay_readable():
    lengths = {p: len(p.read_text().splitlines()) for p in CORE_FILES + ROS_FILES}
    assert {str(p): n for p, n in lengths.items() if n > 350} == {}
