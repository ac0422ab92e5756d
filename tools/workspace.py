"""Sets up `.venv` in the tree and runs the demo, the tests or a shell command in it.

Needs nothing but Python 3.11 or 3.12, a C++ compiler and a package index. What is already set
up is used again: each step leaves a stamp of what it was made from.

`test --leg NAME` runs a selection of the tests in an environment of its own, `.venv-NAME`, in which
the versions of `tools/constraints-NAME.txt` stand in place of the usual ones.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
TOOLS = ROOT / "tools"
DEMO_BAG = ROOT / "bags" / "demo.mcap"
# What a leg runs: the library with its examples, two tests at a time; then the conversions, bags
# and live graphs, one after the other.
LEG_LIBRARY = ("geoprim_core", "test/core", "test/contracts")
LEG_ROS = tuple(
    f"test/ros/test_ros_{name}.py" for name in ("messages", "images", "bags", "nodes", "examples")
)

# What `geoprim warm` compiles, and what of it the demo needs: the rest takes longer.
KERNELS = ("detection", "fitting", "schemes", "polygons", "tangents")
DEMO_KERNELS = ("detection",)


class Environment(NamedTuple):
    """A virtual environment in the tree; without a leg it is the usual one."""

    leg: str = ""

    @property
    def folder(self) -> Path:
        """Where it lies."""
        return ROOT / (f".venv-{self.leg}" if self.leg else ".venv")

    @property
    def python(self) -> Path:
        """Its Python."""
        return self.folder / "bin" / "python"

    @property
    def stamps(self) -> Path:
        """What its steps were made from."""
        return self.folder / "geoprim-stamps.json"

    @property
    def constraints(self) -> tuple[Path, ...]:
        """The files with its versions; a later one is laid over an earlier one."""
        names = ("constraints", f"constraints-{self.leg}") if self.leg else ("constraints",)
        return tuple(TOOLS / f"{name}.txt" for name in names)

    def variables(self) -> dict[str, str]:
        """Return the variables of its processes."""
        variables = dict(os.environ)
        for name in ("PYTHONHOME", "PYTHONPATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE"):
            variables.pop(name, None)
        path = f"{self.folder / 'bin'}{os.pathsep}{variables.get('PATH', os.defpath)}"
        return {**variables, "VIRTUAL_ENV": str(self.folder), "PATH": path}

    def call(self, command: Sequence[str | Path]) -> int:
        """Run a command in it, in this folder, and return its exit code."""
        words = [str(word) for word in command]
        return subprocess.run(words, env=self.variables(), cwd=ROOT).returncode

    def pip(self, *words: str | Path) -> subprocess.CompletedProcess[str]:
        """Run its pip and keep what it prints."""
        command = [self.python, "-m", "pip", "--disable-pip-version-check", *words]
        return subprocess.run(command, capture_output=True, text=True, env=self.variables())

    @contextlib.contextmanager
    def stamped(self, step: str, made_from: str, *, wipe: bool = False) -> Iterator[bool]:
        """Tell whether a step has to run; when its block ends well, remember its sources."""
        stale = self._stamps().get(step) != made_from
        yield stale
        if stale:
            stamps = {} if wipe else self._stamps()
            self.stamps.write_text(json.dumps({**stamps, step: made_from}, indent=1))

    def _stamps(self) -> dict[str, str]:
        return dict(json.loads(self.stamps.read_text())) if self.stamps.exists() else {}


class SetupError(Exception):
    """Something the person has to mend; the message is one sentence."""


def main() -> int:
    """Run one command and turn what the person has to mend into one sentence."""
    parser = argparse.ArgumentParser(prog="./run", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("setup", help="only set up the environment and build the demo bag")
    commands.add_parser("demo", help="set up, run the live graph on the demo bag, show the results")
    test = commands.add_parser("test", help="set up and run all checks and tests")
    legs = sorted(p.stem.removeprefix("constraints-") for p in TOOLS.glob("constraints-*.txt"))
    test.add_argument("--leg", default="", choices=legs, help="with other versions, in .venv-LEG")
    shell = commands.add_parser("exec", help="run a command in the environment")
    shell.add_argument("words", nargs=argparse.REMAINDER)
    arguments, rest = parser.parse_known_args()
    start = time.monotonic()
    environment = Environment(getattr(arguments, "leg", ""))
    try:
        with exclusive():
            set_up(environment, DEMO_KERNELS if arguments.command == "demo" else KERNELS)
        say(f"set-up ready after {time.monotonic() - start:.1f} s")
        return run(environment, arguments, rest)
    except SetupError as problem:
        print(f"geoprim: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def run(environment: Environment, arguments: argparse.Namespace, rest: list[str]) -> int:
    """Run what was asked for in the environment and return its exit code."""
    if arguments.command == "setup":
        return 0
    if arguments.command == "demo":
        demo: list[str | Path] = [environment.python, "-m", "geoprim_ros.demo", "--bag", DEMO_BAG]
        return environment.call([*demo, *rest])
    if arguments.command == "exec":
        return environment.call([*arguments.words, *rest])
    return test(environment, rest)


def test(environment: Environment, rest: list[str]) -> int:
    """Run the linters and all tests, or those of the leg; extra words go to pytest."""
    pytest: list[str | Path] = [environment.python, "-m", "pytest", "-q"]
    if environment.leg and not rest:
        library = environment.call([*pytest, "-n", "2", *LEG_LIBRARY])
        return environment.call([*pytest, *LEG_ROS]) or library
    if environment.leg:
        return environment.call([*pytest, *rest])
    for words in (["ruff", "check", "."], ["ruff", "format", "--check", "."], ["mypy"]):
        say(" ".join(words))
        code = environment.call([environment.folder / "bin" / words[0], *words[1:]])
        if code:
            return code
    if rest:
        return environment.call([*pytest, *rest])
    library = environment.call([*pytest, "-n", "2", "--ignore=test/ros"])
    return environment.call([*pytest, "test/ros"]) or library


def set_up(environment: Environment, kernels: Sequence[str]) -> None:
    """Bring an environment up to date: packages, messages, geoprim itself, kernels, bag."""
    check_machine(environment)
    made_from = f"{sys.version_info[:2]} {environment.folder}"
    with environment.stamped("environment", made_from, wipe=True) as stale:
        if stale:
            make_environment(environment)
    requirements = TOOLS / "requirements.txt"
    with environment.stamped("packages", digest(requirements, *environment.constraints)) as stale:
        if stale:
            install_packages(environment, requirements)
    build_messages(environment)
    with environment.stamped("geoprim", digest(ROOT / "setup.py")) as stale:
        if stale:
            install_geoprim(environment)
    warm_kernels(environment, kernels)
    if not environment.leg:  # its tests build the bags that they need
        build_demo_bag(environment)


def check_machine(environment: Environment) -> None:
    """Say in one sentence what is missing on this machine."""
    compiler = os.environ.get("CXX") or next(filter(shutil.which, ("c++", "g++", "clang++")), None)
    if compiler is None or shutil.which(compiler.split()[0]) is None:
        raise SetupError(
            "a C++ compiler is needed to build the messages and none was found; install g++ or "
            "clang++, or name one: CXX=/path/to/compiler ./run demo"
        )
    if not os.access(ROOT, os.W_OK):
        raise SetupError(f"the set-up goes into {environment.folder}, but {ROOT} cannot be written")


def make_environment(environment: Environment) -> None:
    """Create the environment with the Python that runs this script."""
    say(f"creating {environment.folder.name} (Python {sys.version.split()[0]})")
    words = [sys.executable, "-m", "venv", "--clear", environment.folder]
    made = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if made.returncode:
        raise SetupError(
            "the virtual environment could not be created; on Debian and Ubuntu the package "
            f"python3-venv is needed ({last_line(made.stdout + made.stderr)})"
        )


def install_packages(environment: Environment, requirements: Path) -> None:
    """Install the pinned packages from the package index."""
    pins = pins_of(*environment.constraints)
    probe = ("install", "--dry-run", "--no-deps", "--ignore-installed", "--retries", "1")
    if environment.pip(*probe, pins["tqdm"]).returncode:
        raise SetupError(
            "the package index cannot be reached; the first set-up needs a network connection, "
            "or an index named in PIP_INDEX_URL"
        )
    say("installing the pinned packages (about a minute)")
    constraints = environment.folder / "constraints.txt"
    constraints.write_text("\n".join(pins.values()) + "\n")
    answer = environment.pip("install", "-q", "-r", requirements, "-c", constraints)
    if answer.returncode:
        reason = last_line(answer.stdout + answer.stderr)
        raise SetupError(f"pip could not install the packages: {reason}")


def pins_of(*constraints: Path) -> dict[str, str]:
    """Return package -> its line in the last of the files that has one."""
    lines = [line for file in constraints for line in file.read_text().splitlines()]
    return {line.partition("==")[0]: line for line in lines if "==" in line}


def build_messages(environment: Environment) -> None:
    """Build geoprim_msgs into the environment; the tool itself knows when that is needed."""
    words = [TOOLS / "build_msgs.py", ROOT / "msg_defs" / "geoprim_msgs"]
    if environment.call([environment.python, *words]):
        raise SetupError("the messages could not be built; the reason stands above")


def install_geoprim(environment: Environment) -> None:
    """Install geoprim_core and geoprim_ros from the tree, editable."""
    plain_path = (
        "editable_mode=compat"  # a .pth line: new modules are seen without installing again
    )
    words = ("install", "-q", "--no-deps", "--no-build-isolation")
    # The short -C came with pip 23.1; Debian 12 has 23.0.
    answer = environment.pip(*words, "--config-settings", plain_path, "-e", ROOT)
    if answer.returncode:
        raise SetupError(f"geoprim could not be installed: {last_line(answer.stderr)}")


def warm_kernels(environment: Environment, parts: Sequence[str]) -> None:
    """Compile parts of the numeric kernels once, so that nobody waits for them later."""
    sources = sorted((ROOT / "geoprim_core").rglob("_kernels*.py"))
    made_from = digest(ROOT / "geoprim_core" / "_jit.py", *sources)
    with contextlib.ExitStack() as stamps:
        each = [(p, environment.stamped(f"kernels of {p}", made_from)) for p in parts]
        stale = [part for part, stamp in each if stamps.enter_context(stamp)]
        if not stale:
            return
        say("compiling the kernels (some minutes)")
        if environment.call([environment.python, "-m", "geoprim_core.cli.main", "warm", *stale]):
            raise SetupError("the kernels could not be compiled; the reason stands above")


def build_demo_bag(environment: Environment) -> None:
    """Build the demo bag where it is missing or its sources changed."""
    core = ROOT / "geoprim_core"
    files = ("demo_bag", "photographs", "bag_writer", "wire", "image_message", "camera_message")
    sources = [*sorted((core / "synthetic").glob("*.py")), core / "applications" / "sorting.py"]
    sources += [core / "io" / f"{name}.py" for name in files]
    words = [environment.python, ROOT / "bags" / "build_demo_bag.py", DEMO_BAG]
    with environment.stamped("demo bag", digest(*sources)) as stale:
        if (stale or not DEMO_BAG.exists()) and environment.call(words):
            raise SetupError("the demo bag could not be built; the reason stands above")


@contextlib.contextmanager
def exclusive() -> Iterator[None]:
    """Let one set-up run at a time in this tree."""
    lock = ROOT / ".venv.lock"
    try:
        handle = lock.open("w")
    except OSError:
        raise SetupError(f"the set-up goes into {ROOT}, which cannot be written") from None
    with handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def digest(*files: Path) -> str:
    """Return a digest of the contents of files."""
    total = hashlib.sha256()
    for file in files:
        total.update(file.name.encode() + b"\0" + file.read_bytes())
    return total.hexdigest()[:16]


def last_line(text: str) -> str:
    """Return the last line that says something."""
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "no reason")


def say(text: str) -> None:
    """Print what is being done."""
    print(f"geoprim: {text}", flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
