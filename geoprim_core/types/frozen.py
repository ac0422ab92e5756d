"""What the checked data types share."""

from __future__ import annotations

from typing import Any


class Frozen:
    """Lets a frozen dataclass put the checked form of an argument in place."""

    __slots__ = ()

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)
