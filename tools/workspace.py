"""Sets up `.venv` in the tree and runs the demo, the tests or a shell command in it.

Needs nothing but Python 3.11 or 3.12, a C++ compiler and a package index. What is already set
up is used again: each step leaves a stamp of what it was made from.
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
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
STAMPS = VENV / "geoprim-stamps.json"
DEMO_BAG = ROOT / "bags" / "demo.mcap"


class SetupError(Exception):
    """Something the person has to mend; the message is one sentence."""


def main() -> int:
    """Run one command and turn what the person has to mend into one sentence."""
    parser = argparse.ArgumentParser(prog="./run", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("setup", help="only set up the environment and build the demo bag")
    commands.add_parser("demo", help="set up, run the live graph on the demo bag, show the results")
    commands.add_parser("test", help="set up and run all checks and tests")
    shell = commands.add_parser("exec", help="run a command in the environment")
    shell.add_argument("words", nargs=argparse.REMAINDER)
    arguments, rest = parser.parse_known_args()
    start = time.monotonic()
    try:
        with exclusive():
            set_up()
        say(f"set-up ready after {time.monotonic() - start:.1f} s")
        return run(arguments, rest)
    except SetupError as problem:
        print(f"geoprim: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def run(arguments: argparse.Namespace, rest: list[str]) -> int:
    """Run what was asked for in the environment and return its exit code."""
    if arguments.command == "setup":
        return 0
    if arguments.command == "demo":
        return call([PYTHON, "-m", "geoprim_ros.demo", "--bag", DEMO_BAG, *rest])
    if arguments.command == "exec":
        return call([*arguments.words, *rest])
    return test(rest)


def test(rest: list[str]) -> int:
    """Run the linters and all tests; extra words go to pytest."""
    for words in (["ruff", "check", "."], ["ruff", "format", "--check", "."], ["mypy"]):
        say(" ".join(words))
        code = call([VENV / "bin" / words[0], *words[1:]])
        if code:
            return code
    return call([PYTHON, "-m", "pytest", "-q", *rest])


def set_up() -> None:
    """Bring the environment up to date: packages, messages, geoprim itself, kernels, bag."""
    check_machine()
    with stamped("environment", f"{sys.version_info[:2]} {VENV}", wipe=True) as stale:
        if stale:
            make_environment()
    requirements = [ROOT / "tools" / name for name in ("requirements.txt", "constraints.txt")]
    with stamped("packages", digest(*requirements)) as stale:
        if stale:
            install_packages(*requirements)
    build_messages()
    with stamped("geoprim", digest(ROOT / "setup.py")) as stale:
        if stale:
            install_geoprim()
    warm_kernels()
    build_demo_bag()


def check_machine() -> None:
    """Say in one sentence what is missing on this machine."""
    compiler = os.environ.get("CXX") or next(filter(shutil.which, ("c++", "g++", "clang++")), None)
    if compiler is None or shutil.which(compiler.split()[0]) is None:
        raise SetupError(
            "a C++ compiler is needed to build the messages and none was found; install g++ or "
            "clang++, or name one: CXX=/path/to/compiler ./run demo"
        )
    if not os.access(ROOT, os.W_OK):
        raise SetupError(f"the set-up goes into {VENV}, but {ROOT} cannot be written")


def make_environment() -> None:
    """Create `.venv` with the Python that runs this script."""
    say(f"creating {VENV.relative_to(ROOT)} (Python {sys.version.split()[0]})")
    made = subprocess.run(
        [sys.executable, "-m", "venv", "--clear", VENV], capture_output=True, text=True
    )
    if made.returncode:
        raise SetupError(
            "the virtual environment could not be created; on Debian and Ubuntu the package "
            f"python3-venv is needed ({last_line(made.stdout + made.stderr)})"
        )


def install_packages(requirements: Path, constraints: Path) -> None:
    """Install the pinned packages from the package index."""
    probe = ("install", "--dry-run", "--no-deps", "--ignore-installed", "--retries", "1")
    if pip(*probe, pin_of("tqdm", constraints)).returncode:
        raise SetupError(
            "the package index cannot be reached; the first set-up needs a network connection, "
            "or an index named in PIP_INDEX_URL"
        )
    say("installing the pinned packages (about a minute)")
    answer = pip("install", "-q", "-r", requirements, "-c", constraints)
    if answer.returncode:
        reason = last_line(answer.stdout + answer.stderr)
        raise SetupError(f"pip could not install the packages: {reason}")


def pin_of(package: str, constraints: Path) -> str:
    """Return the line of a package in the constraints."""
    lines = constraints.read_text().splitlines()
    return next(line for line in lines if line.startswith(f"{package}=="))


def build_messages() -> None:
    """Build geoprim_msgs into the environment; the tool itself knows when that is needed."""
    code = call([PYTHON, ROOT / "tools" / "build_msgs.py", ROOT / "msg_defs" / "geoprim_msgs"])
    if code:
        raise SetupError("the messages could not be built; the reason stands above")


def install_geoprim() -> None:
    """Install geoprim_core and geoprim_ros from the tree, editable."""
    plain_path = (
        "editable_mode=compat"  # a .pth line: new modules are seen without installing again
    )
    words = ("install", "-q", "--no-deps", "--no-build-isolation", "-C", plain_path, "-e", ROOT)
    answer = pip(*words)
    if answer.returncode:
        raise SetupError(f"geoprim could not be installed: {last_line(answer.stderr)}")


def warm_kernels() -> None:
    """Compile the numeric kernels once, so that nobody waits for them later."""
    sources = sorted((ROOT / "geoprim_core").rglob("_kernels*.py"))
    with stamped("kernels", digest(ROOT / "geoprim_core" / "_jit.py", *sources)) as stale:
        if not stale:
            return
        say("compiling the kernels (about a minute)")
        if call([PYTHON, "-m", "geoprim_core.cli.main", "warm"]):
            raise SetupError("the kernels could not be compiled; the reason stands above")


def build_demo_bag() -> None:
    """Build the demo bag where it is missing or its sources changed."""
    core = ROOT / "geoprim_core"
    files = ("demo_bag", "photographs", "bag_writer", "wire", "image_message", "camera_message")
    sources = [*sorted((core / "synthetic").glob("*.py")), core / "applications" / "sorting.py"]
    sources += [core / "io" / f"{name}.py" for name in files]
    with stamped("demo bag", digest(*sources)) as stale:
        if (stale or not DEMO_BAG.exists()) and call(
            [PYTHON, ROOT / "bags" / "build_demo_bag.py", DEMO_BAG]
        ):
            raise SetupError("the demo bag could not be built; the reason stands above")


@contextlib.contextmanager
def stamped(step: str, made_from: str, *, wipe: bool = False) -> Iterator[bool]:
    """Tell whether a step has to run; when its block ends well, remember what it was made from."""
    stamps = json.loads(STAMPS.read_text()) if STAMPS.exists() else {}
    stale = stamps.get(step) != made_from
    yield stale
    if stale:
        stamps = {} if wipe else json.loads(STAMPS.read_text()) if STAMPS.exists() else {}
        STAMPS.write_text(json.dumps({**stamps, step: made_from}, indent=1))


@contextlib.contextmanager
def exclusive() -> Iterator[None]:
    """Let one set-up run at a time in this tree."""
    lock = ROOT / ".venv.lock"
    try:
        handle = lock.open("w")
    except OSError:
        raise SetupError(f"the set-up goes into {VENV}, but {ROOT} cannot be written") from None
    with handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def digest(*files: Path) -> str:
    """Return a digest of the contents of files."""
    total = hashlib.sha256()
    for file in files:
        total.update(file.name.encode() + b"\0" + file.read_bytes())
    return total.hexdigest()[:16]


def pip(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """Run pip of the environment and keep what it prints."""
    command = [PYTHON, "-m", "pip", "--disable-pip-version-check", *words]
    return subprocess.run(command, capture_output=True, text=True, env=environment())


def call(command: list[str | Path]) -> int:
    """Run a command in the environment, in this folder, and return its exit code."""
    return subprocess.run([str(word) for word in command], env=environment(), cwd=ROOT).returncode


def environment() -> dict[str, str]:
    """Return the variables of the environment's processes."""
    variables = dict(os.environ)
    for name in ("PYTHONHOME", "PYTHONPATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE"):
        variables.pop(name, None)
    path = f"{VENV / 'bin'}{os.pathsep}{variables.get('PATH', os.defpath)}"
    return {**variables, "VIRTUAL_ENV": str(VENV), "PATH": path}


def last_line(text: str) -> str:
    """Return the last line that says something."""
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "no reason")


def say(text: str) -> None:
    """Print what is being done."""
    print(f"geoprim: {text}", flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
