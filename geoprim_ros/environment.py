"""What ROS 2 reads from the environment, set where nobody has set it.

A sourced workspace sets these variables; in an environment made of pip wheels nothing does, and
the nodes shall start there as plain Python modules. The package calls `prepare` when it is
imported, before any module of it imports rclpy.
"""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

# Of malloc.h. Larger blocks than glibc's own limit for its heaps still go back at once.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_KEPT_BYTES = 32 * 1024 * 1024
_PROFILE_VARIABLES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")


def config_folder() -> Path | None:
    """Return the folder of the scenario files and the Fast DDS profile, or None.

    In a source tree that is `config` beside the package, else the installed share folder.
    """
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    shares = [Path(p, "share", "geoprim_ros", "config") for p in (*prefixes, sys.prefix)]
    candidates = [Path(__file__).resolve().parents[1] / "config", *shares]
    return next((c for c in candidates if (c / "fastdds.xml").is_file()), None)


def keep_freed_memory() -> None:
    """Let the C library keep freed image buffers for the next frame.

    By default glibc hands buffers of this size back to the system after every frame, and getting
    them anew, page by page, costs a quarter of the edge stage. Where there is no `mallopt`, as
    with other C libraries, things stay as they are.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _KEPT_BYTES)
        mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)


def prepare() -> None:
    """Set the variables that ROS 2 needs; what is set already stays as it is."""
    keep_freed_memory()
    wheels = Path(sys.prefix, "share", "ament_index")
    if wheels.is_dir() and not os.environ.get("AMENT_PREFIX_PATH"):
        os.environ["AMENT_PREFIX_PATH"] = sys.prefix
        _keep_logs_in(Path(sys.prefix, "log", "ros"))
    folder = config_folder()
    if folder is not None and not any(os.environ.get(name) for name in _PROFILE_VARIABLES):
        os.environ[_PROFILE_VARIABLES[0]] = str(folder / "fastdds.xml")


def _keep_logs_in(folder: Path) -> None:
    """Keep the logs, one file a process, out of the home folder; rclpy makes the folder."""
    chosen = os.environ.get("ROS_LOG_DIR") or os.environ.get("ROS_HOME")
    if not chosen and os.access(sys.prefix, os.W_OK):
        os.environ["ROS_LOG_DIR"] = str(folder)
