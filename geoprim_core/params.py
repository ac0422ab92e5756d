"""Parameters: one frozen class per method or stage, one declaration per field.

The declaration of a field (`option`) holds its default, text, unit and range. The Python
argument, the command-line option, the ROS parameter with its descriptor, the YAML key and the
text of a refusal are all made from it.

Examples
--------
>>> from dataclasses import dataclass
>>> @dataclass(frozen=True)
... class BlurParams(Params):
...     sigma: float = option(1.0, "standard deviation of the blur", unit="px", low=0.0, high=20.0)
>>> BlurParams().sigma
1.0
>>> BlurParams(sigma=99.0)
Traceback (most recent call last):
...
geoprim_core.errors.ParameterError: sigma: expected a number from 0.0 to 20.0 px, got 99.0 (float)
"""

from __future__ import annotations

import dataclasses
import difflib
import math
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Self, cast

from geoprim_core._check import describe, with_article
from geoprim_core.errors import ParameterError

Scalar = bool | int | float | str


@dataclass(frozen=True)
class Option:
    """The declaration of one parameter.

    `name` is dotted for a field of a nested Params class ("edges.sigma").
    """

    name: str
    default: Scalar
    text: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()

    @property
    def kind(self) -> type:
        """The Python type of the value: bool, int, float or str."""
        return type(self.default)

    def expectation(self) -> str:
        """Say what a value has to be, as in a refusal."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        noun = {bool: "true or false", int: "a whole number", float: "a number", str: "a text"}
        text = noun[self.kind]
        unit = f" {self.unit}" if self.unit else ""
        if self.low is not None and self.high is not None:
            return f"{text} from {self.low} to {self.high}{unit}"
        if self.low is not None:
            return f"{text} of at least {self.low}{unit}"
        if self.high is not None:
            return f"{text} of at most {self.high}{unit}"
        return text

    def checked(self, value: Any) -> Scalar:
        """Return the value in the option's type, or raise `ParameterError`."""
        result = self._typed(value)
        in_range = not isinstance(result, float) or math.isfinite(result)
        if isinstance(result, int | float) and not isinstance(result, bool):
            in_range = in_range and (self.low is None or result >= self.low)
            in_range = in_range and (self.high is None or result <= self.high)
        if not in_range or (self.choices and result not in self.choices):
            raise ParameterError(self.name, self.expectation(), describe(value))
        return result

    def meant(self, value: Any) -> Any:
        """Return a whole number as the number or the text that it stands for, else the value.

        A YAML file says 1 for 1.0, and 2 for the scheme of that name.
        """
        if type(value) is int and self.kind is float:
            return float(value)
        return str(value) if type(value) is int and str(value) in self.choices else value

    def _typed(self, value: Any) -> Scalar:
        if hasattr(value, "item") and getattr(value, "ndim", 1) == 0:
            value = value.item()  # a numpy scalar
        value = self.meant(value)
        if type(value) is not self.kind:
            raise ParameterError(self.name, self.expectation(), describe(value))
        return cast(Scalar, value)


def option(
    default: Scalar,
    text: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
) -> Any:
    """Declare one field of a Params class."""
    declared = Option("", default, text, unit, low, high, choices)
    return dataclasses.field(default=default, metadata={"option": declared})


def group(params: type[Params]) -> Any:
    """Declare a field that holds another Params object, by default a default one."""
    return dataclasses.field(default_factory=params, metadata={"group": params})


class Params:
    """Base of all parameter classes; subclasses are frozen dataclasses of `option` and `group`."""

    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    def __post_init__(self) -> None:
        """Check every field; a numpy scalar or an int for a float is converted."""
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if "group" in field.metadata:
                wanted = field.metadata["group"]
                if not isinstance(value, wanted):
                    raise ParameterError(field.name, with_article(wanted.__name__), describe(value))
                continue
            declared = dataclasses.replace(field.metadata["option"], name=field.name)
            object.__setattr__(self, field.name, declared.checked(value))

    @classmethod
    def options(cls, prefix: str = "") -> Iterator[Option]:
        """Yield every option, nested ones under their dotted name."""
        for field in dataclasses.fields(cls):
            name = prefix + field.name
            if "group" in field.metadata:
                yield from field.metadata["group"].options(name + ".")
            else:
                yield dataclasses.replace(field.metadata["option"], name=name)

    def to_dict(self) -> dict[str, Scalar]:
        """Return all values under their dotted names."""
        values: dict[str, Scalar] = {}
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Params):
                values.update({f"{field.name}.{k}": v for k, v in value.to_dict().items()})
            else:
                values[field.name] = value
        return values

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Build from a mapping with dotted or nested names; what is absent keeps its default."""
        return cls().updated(values)

    def updated(self, values: Mapping[str, Any]) -> Self:
        """Return a copy with some values changed, given under dotted or nested names.

        Raises
        ------
        ParameterError
            A name is unknown (the nearest known one is offered) or a value is refused.
        """
        flat = dict(_flattened(values))
        known = {o.name: o for o in self.options()}
        for name, value in flat.items():
            if name not in known:
                near = difflib.get_close_matches(name, known, 1)
                hint = f"did you mean {near[0]!r}?" if near else "known: " + ", ".join(known)
                raise ParameterError(name, f"a parameter of {type(self).__name__} ({hint})", name)
            known[name].checked(value)
        return self._rebuilt(flat)

    def _rebuilt(self, flat: Mapping[str, Any]) -> Self:
        changes: dict[str, Any] = {}
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Params):
                start = field.name + "."
                inner = {k[len(start) :]: v for k, v in flat.items() if k.startswith(start)}
                changes[field.name] = value._rebuilt(inner) if inner else value
            elif field.name in flat:
                changes[field.name] = flat[field.name]
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]


def _flattened(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


@cache
def _defaults(wanted: Hashable) -> Any:
    """Return the default object of a class: frozen, so one serves all; checking takes time."""
    return cast(type[Any], wanted)()


def as_params(value: Any, wanted: type[Any], argument: str = "params") -> Any:
    """Return `value`, a default object for None, or raise for another class."""
    if value is None:
        return _defaults(cast(Hashable, wanted))
    if not isinstance(value, wanted):
        raise ParameterError(argument, f"{with_article(wanted.__name__)} or None", describe(value))
    return value
