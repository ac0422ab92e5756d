"""Command-line options made from Params classes."""

from __future__ import annotations

import argparse
from typing import Any

from geoprim_core.errors import ParameterError
from geoprim_core.params import Option, Params


def add_params(parser: argparse.ArgumentParser, params: type[Params], title: str) -> None:
    """Add one option a parameter, named as in Python and YAML ("--edges.sigma").

    Examples
    --------
    >>> from geoprim_core.tangent import DebParams
    >>> parser = argparse.ArgumentParser()
    >>> add_params(parser, DebParams, "tangents")
    >>> given_params(parser.parse_args(["--radius", "6"]), DebParams)
    {'radius': 6.0}
    """
    about = "every parameter of the chain; see docs/parameters.md"
    section = parser.add_argument_group(title, about)
    for declared in params.options():
        section.add_argument(
            f"--{declared.name}",
            dest=_destination(declared),
            type=_reader(declared),
            metavar=_metavar(declared),
            default=None,
            help=_help(declared),
        )


def given_params(arguments: argparse.Namespace, params: type[Params]) -> dict[str, Any]:
    """Return the parameters that were given on the command line, under their dotted names."""
    values = {o.name: getattr(arguments, _destination(o)) for o in params.options()}
    return {name: value for name, value in values.items() if value is not None}


def _destination(declared: Option) -> str:
    return "param:" + declared.name


def _metavar(declared: Option) -> str:
    return "|".join(declared.choices) if declared.choices else declared.kind.__name__.upper()


def _help(declared: Option) -> str:
    unit = f" [{declared.unit}]" if declared.unit else ""
    default = "none" if declared.default == "" else declared.default
    return f"{declared.text}{unit}; {declared.expectation()} (default {default})".replace("%", "%%")


def _reader(declared: Option) -> Any:
    def read(text: str) -> Any:
        try:
            return declared.checked(_parsed(declared.kind, text))
        except ParameterError as problem:
            raise argparse.ArgumentTypeError(f"expected {problem.expected}, got {text!r}") from None

    return read


def _parsed(kind: type, text: str) -> Any:
    if kind is bool:
        return {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}.get(
            text.lower(), text
        )
    try:
        return kind(text)
    except ValueError:
        return text
