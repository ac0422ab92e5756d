"""What the package says of itself agrees: versions, what it needs, what it exports."""

import ast
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import geoprim_core

ROOT = Path(__file__).resolve().parents[2]
SETUP = ast.parse((ROOT / "setup.py").read_text())


def assigned(name):
    """Return the literal that setup.py gives a name."""
    (value,) = (
        node.value
        for node in SETUP.body
        if isinstance(node, ast.Assign) and node.targets[0].id == name
    )
    return ast.literal_eval(value)


def keyword(name):
    (call,) = (n.value for n in SETUP.body if isinstance(n, ast.Expr) and hasattr(n.value, "func"))
    (value,) = (word.value for word in call.keywords if word.arg == name)
    return ast.literal_eval(value)


def test_there_is_one_version():
    files = (ROOT / "package.xml", ROOT / "msg_defs" / "geoprim_msgs" / "package.xml")
    told = {re.search(r"<version>(.*)</version>", file.read_text())[1] for file in files}
    assert told == {keyword("version")} == {geoprim_core.__version__}


def test_pip_installs_what_the_set_up_installs_for_the_library():
    """`pip install .` into an empty environment had given a command without numpy."""
    text = (ROOT / "tools" / "requirements.txt").read_text()
    (part,) = re.findall(r"# the library\n(.*?)\n\n", text, re.DOTALL)
    assert sorted(part.split()) == sorted(assigned("LIBRARY"))


def test_every_module_of_the_library_is_imported_without_the_rest():
    late = ("matplotlib", "skimage", "foxglove", "rclpy", "geoprim_msgs", "sensor_msgs", "shapely")
    script = (
        "import sys, pkgutil, importlib, geoprim_core\n"
        f"sys.modules.update(dict.fromkeys({late}))\n"
        "for found in pkgutil.walk_packages(geoprim_core.__path__, 'geoprim_core.'):\n"
        "    importlib.import_module(found.name)\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_a_room_is_there_when_it_is_named():
    """`import geoprim_core; geoprim_core.types.Contours` had failed until another call."""
    rooms = geoprim_core._ROOMS
    assert set(rooms) <= set(dir(geoprim_core))
    named = ", ".join(f"geoprim_core.{room}.__name__" for room in rooms)
    words = [sys.executable, "-c", f"import geoprim_core; print({named})"]
    answer = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    assert answer == [f"geoprim_core.{room}" for room in rooms]


@pytest.mark.parametrize("name", geoprim_core.__all__)
def test_a_public_name_comes_from_its_module(name):
    home = import_module(f"geoprim_core.{geoprim_core._HOMES[name]}")
    assert getattr(geoprim_core, name) is getattr(home, name)
