"""QoS profiles in the YAML of rosbag2: those that a bag keeps, and files that override them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml
from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from geoprim_core.errors import FileError, InputError

_POLICIES: dict[str, Any] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
_TIMES = ("deadline", "lifespan", "liveliness_lease_duration")
_SECOND_NS = 1_000_000_000
Policies = dict[str, Any]


def read_overrides(path: str | Path) -> dict[str, Policies]:
    """Read a file of QoS overrides as `ros2 bag` takes it: topic -> policies.

    Raises
    ------
    FileError
        The file cannot be read or is not YAML.
    InputError
        A policy or its value is not known.
    """
    try:
        content = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as problem:
        text = " ".join(str(problem).split())
        raise FileError(f"cannot read the QoS overrides {path}: {text}") from None
    if not isinstance(content, dict):
        raise InputError(str(path), "topics with QoS policies below them", repr(content))
    return {str(topic): _policies(f"{path}: {topic}", text) for topic, text in content.items()}


def offered_policies(text: str) -> list[Policies]:
    r"""Return the profiles of the publishers of a topic as a bag keeps them; none if unreadable.

    Examples
    --------
    >>> offered_policies("- durability: transient_local\n  depth: 1\n")[0]["durability"].name
    'TRANSIENT_LOCAL'
    >>> offered_policies("- durability: 1\n")[0]["durability"].name  # before Jazzy
    'TRANSIENT_LOCAL'
    """
    try:
        content = yaml.safe_load(text) or []
        return [_policies("offered_qos_profiles", entry) for entry in content]
    except (yaml.YAMLError, InputError, TypeError):
        return []


def offered_text(profiles: Iterable[QoSProfile]) -> str:
    """Return the profiles of publishers as a bag keeps them."""
    entries = [
        {
            "history": p.history.short_key,
            "depth": p.depth,
            "reliability": p.reliability.short_key,
            "durability": p.durability.short_key,
            "deadline": _seconds_and_rest(p.deadline),
            "lifespan": _seconds_and_rest(p.lifespan),
            "liveliness": p.liveliness.short_key,
            "liveliness_lease_duration": _seconds_and_rest(p.liveliness_lease_duration),
            "avoid_ros_namespace_conventions": bool(p.avoid_ros_namespace_conventions),
        }
        for p in profiles
    ]
    return str(yaml.safe_dump(entries, sort_keys=False)) if entries else ""


def profile(base: QoSProfile, *policies: Mapping[str, Any]) -> QoSProfile:
    """Return a profile with some policies in the place of its own, the later ones first."""
    own = {name: getattr(base, name) for name in (*_POLICIES, "depth", *_TIMES)}
    for changes in policies:
        own |= changes
    return QoSProfile(**own)


def is_latched(policies: Mapping[str, Any]) -> bool:
    """Tell whether late readers get the last messages."""
    return bool(policies.get("durability") == DurabilityPolicy.TRANSIENT_LOCAL)


def _policies(where: str, entry: object) -> Policies:
    if not isinstance(entry, dict):
        raise InputError(where, "QoS policies", repr(entry))
    found: Policies = {}
    for name, value in entry.items():
        if name in _POLICIES:
            found[name] = _policy(f"{where}.{name}", _POLICIES[name], value)
        elif name in _TIMES:
            found[name] = _duration(f"{where}.{name}", value)
        elif name == "depth":
            if not isinstance(value, int) or isinstance(value, bool) or value < 0:
                raise InputError(f"{where}.depth", "a number of messages", repr(value))
            found[name] = value
        elif name != "avoid_ros_namespace_conventions":
            known = ", ".join((*_POLICIES, "depth", *_TIMES))
            raise InputError(where, f"policies among {known}", repr(name))
    return found


def _policy(where: str, kind: Any, value: object) -> Any:
    """Return a policy by its name, or its number as files before Jazzy have it."""
    number = isinstance(value, int) and not isinstance(value, bool)
    try:
        return kind(value if number else kind.get_from_short_key(value))
    except (KeyError, ValueError, AttributeError, TypeError):
        names = ", ".join(policy.short_key for policy in kind if policy.short_key != "unknown")
        raise InputError(where, f"one of {names}", repr(value)) from None


def _duration(where: str, value: object) -> Duration:
    parts = value if isinstance(value, dict) else {}
    seconds, rest = parts.get("sec"), parts.get("nsec", 0)
    if not (isinstance(seconds, int) and isinstance(rest, int) and seconds >= 0 and rest >= 0):
        raise InputError(where, "a time as sec and nsec", repr(value))
    return Duration(nanoseconds=min(seconds * _SECOND_NS + rest, Infinite.nanoseconds))


def _seconds_and_rest(duration: Duration) -> dict[str, int]:
    seconds, rest = divmod(duration.nanoseconds, _SECOND_NS)
    return {"sec": seconds, "nsec": rest}
