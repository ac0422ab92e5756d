"""What the checked data types share."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Self

import numpy as np

_SHOWN = 6  # numbers; a larger array is told by its shape


class Frozen:
    """Lets a frozen dataclass put the checked form of an argument in place."""

    __slots__ = ()

    def __repr__(self) -> str:
        """Return all fields; of long arrays only shape and type."""
        named = ((f.name, getattr(self, f.name)) for f in fields(self))  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(f'{k}={_brief(v)}' for k, v in named)})"

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


def _brief(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > _SHOWN:
        return f"<{value.dtype} {value.shape}>"
    if isinstance(value, tuple) and len(value) > _SHOWN:
        return f"<{len(value)} of {type(value[0]).__name__}>"
    return repr(value)
