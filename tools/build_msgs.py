"""Build a ROS 2 interface package against the pip wheels of ROS 2 and install it beside them.

    .venv/bin/python tools/build_msgs.py msg_defs/geoprim_msgs

The prefix is that of the running Python (`sys.prefix`), where the wheels live, so the messages
import with nothing to source. The work is done again only when the sources, the Python, this
tool or the versions of the ROS packages changed; a stamp in the prefix remembers them.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

TOOLS = Path(__file__).resolve().parent
PRUNE = TOOLS / "prune_wheel_includes.cmake"


class BuildError(Exception):
    """The messages cannot be built; the text says why and what to do."""


def check_compiler(language: str, variable: str, names: tuple[str, ...]) -> None:
    """Say what is missing where CMake would find no compiler."""
    chosen = os.environ.get(variable, "").split()
    if chosen and shutil.which(chosen[0]) is None:
        raise BuildError(f"{variable} names a {language} compiler that is not there: {chosen[0]}.")
    if not chosen and not any(shutil.which(name) for name in names):
        raise BuildError(
            f"No {language} compiler was found ({', '.join(names)}): the ROS messages are compiled "
            f"on this machine; install one (Debian, Ubuntu: the package g++) or set {variable}."
        )


def fingerprint(source: Path) -> str:
    """Return a digest of all that the built package depends on."""
    digest = hashlib.sha256(f"{sys.version} {sys.prefix}".encode())
    wheels = {
        f"{d.name}=={d.version}"
        for d in metadata.distributions()
        if d.name.startswith(("ros-", "ros_", "rosidl"))
    }
    digest.update("\n".join(sorted(wheels)).encode())
    for path in [Path(__file__), PRUNE, *sorted(p for p in source.rglob("*") if p.is_file())]:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def environment() -> dict[str, str]:
    """Return the environment of the build: the ROS wheels of this prefix and nothing else."""
    values = dict(os.environ, VIRTUAL_ENV=sys.prefix)
    values["AMENT_PREFIX_PATH"] = values["CMAKE_PREFIX_PATH"] = sys.prefix
    values["PATH"] = f"{sys.prefix}/bin{os.pathsep}{os.environ.get('PATH', '')}"
    values.pop("PYTHONHOME", None)
    return values


def run(command: list[str], log: Path) -> None:
    """Run one step of the build; a failure shows the end of what it printed."""
    with log.open("ab") as out:
        code = subprocess.run(command, stdout=out, stderr=out, env=environment()).returncode
    if code != 0:
        tail = "\n".join(log.read_text(errors="replace").splitlines()[-40:])
        raise BuildError(f"{tail}\nThe step above failed: {' '.join(command)}")


def find_tools() -> list[str]:
    """Return the start of the CMake command line, or say what is missing on this machine."""
    check_compiler("C++", "CXX", ("c++", "g++", "clang++"))
    check_compiler("C", "CC", ("cc", "gcc", "clang"))
    path = environment()["PATH"]
    cmake, ninja = shutil.which("cmake", path=path), shutil.which("ninja", path=path)
    if cmake is None:
        raise BuildError("cmake was not found: install it with pip install cmake.")
    if ninja is None and shutil.which("make", path=path) is None:
        raise BuildError("Neither ninja nor make was found: pip install ninja.")
    return [cmake, *(("-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={ninja}") if ninja else ())]


def build(source: Path, tools: list[str]) -> None:
    """Configure, compile and install the package into the prefix of this Python."""
    with tempfile.TemporaryDirectory(prefix="geoprim_msgs_") as folder:
        log = Path(folder, "log")
        run(
            [
                *(*tools, "-S", str(source), "-B", folder),
                "-DCMAKE_BUILD_TYPE=Release",  # with assertions, a numpy float in a field aborts
                "-DBUILD_TESTING=OFF",
                f"-DCMAKE_INSTALL_PREFIX={sys.prefix}",
                f"-DPython3_EXECUTABLE={sys.executable}",
                f"-DCMAKE_PROJECT_INCLUDE={PRUNE}",
            ],
            log,
        )
        jobs = str(os.cpu_count() or 1)
        run([tools[0], "--build", folder, "--target", "install", "--parallel", jobs], log)


def is_current(stamp: Path, wanted: str) -> bool:
    """Say whether the installed package is the one that a build would make now."""
    return stamp.is_file() and stamp.read_text() == wanted


def main(args: list[str] | None = None) -> int:
    """Build where it is needed; return 0, or 1 after a sentence that says what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, help="folder of the interface package")
    parser.add_argument("--force", action="store_true", help="build even if nothing changed")
    options = parser.parse_args(args)
    source = options.source.resolve()
    try:
        if not (source / "package.xml").is_file():
            raise BuildError(f"{options.source} holds no package.xml: not a ROS package.")
        stamp = Path(sys.prefix, "share", source.name, "build_stamp")
        wanted = fingerprint(source)
        if not options.force and is_current(stamp, wanted):
            print(f"{source.name} is up to date.")
            return 0
        tools = find_tools()
        stamp.unlink(missing_ok=True)
        build(source, tools)
        stamp.write_text(wanted)
    except BuildError as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{source.name} is built and installed in {sys.prefix}.")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
