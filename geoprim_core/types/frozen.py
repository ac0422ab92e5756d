"""What the checked data types share."""

from __future__ import annotations

from typing import Any, Self


class Frozen:
    """Lets a frozen dataclass put the checked form of an argument in place."""

    __slots__ = ()

    @classmethod
    def made(cls, sound: bool, **values: Any) -> Self:
        """Build from all fields; without the checks where they are known to be `sound`.

        Then they have the form that the checks would return. For what kernels of this package have
        just made: to look again at each of some ten thousand points costs more than to write them.
        """
        if not sound:
            return cls(**values)
        made = object.__new__(cls)
        made._set(**values)
        return made

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)
