"""The definition texts of message packages that are installed beside ROS's own."""

from __future__ import annotations

import os
import re
from pathlib import Path

_RULE = "=" * 80 + "\n"
# A field that is not of a built-in type: "geometry_msgs/Point[] corners", "Corner[4] corners".
_FIELD = re.compile(r"^\s*(?:(\w+)/)?(?:msg/)?([A-Z]\w*)\s*(?:\[[^\]]*\])?\s+\w+", re.MULTILINE)


def installed_definition(type_name: str) -> str:
    """Return the definition of a type and of all types in it, as bags keep it.

    Empty where one of them is not installed as a .msg file.

    Parameters
    ----------
    type_name : str
        Full name, "sensor_msgs/msg/Image".
    """
    texts: dict[str, str] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop(0)
        if name in texts:
            continue
        text = _text_of(name)
        if text is None:
            return ""
        texts[name] = text
        waiting += _types_in(name.split("/")[0], text)
    main, *parts = texts.items()
    titled = [f"MSG: {name.replace('/msg/', '/')}\n{text}" for name, text in parts]
    return _RULE.join(text.rstrip("\n") + "\n" for text in (main[1], *titled))


def _types_in(package: str, text: str) -> list[str]:
    bare = re.sub(r"#.*", "", text)
    return [f"{other or package}/msg/{name}" for other, name in _FIELD.findall(bare)]


def _text_of(type_name: str) -> str | None:
    package, _, name = type_name.partition("/msg/")
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix, "share", package, "msg", f"{name}.msg")
        if prefix and path.is_file():
            return path.read_text(encoding="utf-8", errors="replace")
    return None
