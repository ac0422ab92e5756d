"""Parameters: one declaration checks everything, and a refusal says what was expected."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.ecc import DetectorParams
from geoprim_core.errors import ParameterError
from geoprim_core.params import Params, group, option


@dataclass(frozen=True)
class Inner(Params):
    sigma: float = option(1.0, "blur", unit="px", low=0.0, high=20.0)
    count: int = option(3, "samples", low=1)
    rule: str = option("a", "a rule", choices=("a", "b"))
    on: bool = option(True, "a switch")


@dataclass(frozen=True)
class Outer(Params):
    inner: Inner = group(Inner)
    scale: float = option(2.0, "a scale")


def test_whole_numbers_stand_for_floats_and_for_names_that_are_numbers():
    """In a YAML file 2 is a number, though it is the name of a scheme."""
    params = DetectorParams.from_dict({"ecc.scheme": 2, "edges.sigma": 1})
    assert params.ecc.scheme == "2"
    assert isinstance(params.edges.sigma, float)
    with pytest.raises(ParameterError, match=r"ecc.scheme: expected one of refined, 1, .*, got 4"):
        DetectorParams.from_dict({"ecc.scheme": 4})
    with pytest.raises(ParameterError, match=r"ecc.scheme: expected one of"):
        DetectorParams.from_dict({"ecc.scheme": True})


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("sigma", -0.1, "from 0.0 to 20.0 px"),
        ("sigma", float("nan"), "from 0.0 to 20.0 px"),
        ("sigma", float("inf"), "from 0.0 to 20.0 px"),
        ("sigma", "1", "a number"),
        ("sigma", True, "a number"),
        ("count", 0, "at least 1"),
        ("count", 1.0, "a whole number"),
        ("rule", "c", "one of a, b"),
        ("on", 1, "true or false"),
    ],
)
def test_refusal_names_parameter_expectation_and_value(name, value, expected):
    with pytest.raises(ParameterError) as refusal:
        Inner(**{name: value})
    assert str(refusal.value).startswith(f"{name}: expected ")
    assert expected in str(refusal.value)
    assert repr(value) in str(refusal.value)


def test_an_int_for_a_float_and_numpy_scalars_are_converted():
    params = Inner(sigma=2, count=np.int64(4), on=np.bool_(False))
    assert (params.sigma, type(params.sigma)) == (2.0, float)
    assert (params.count, type(params.count)) == (4, int)
    assert params.on is False


def test_nested_and_dotted_names_mean_the_same():
    nested = Outer.from_dict({"inner": {"sigma": 3.0}, "scale": 5.0})
    dotted = Outer.from_dict({"inner.sigma": 3.0, "scale": 5.0})
    assert nested == dotted == Outer(Inner(sigma=3.0), 5.0)


def test_an_unknown_name_is_refused_and_the_nearest_offered():
    with pytest.raises(ParameterError, match=r"inner\.sigm: .*did you mean 'inner\.sigma'"):
        Outer.from_dict({"inner.sigm": 3.0})


def test_a_group_of_another_class_is_refused():
    with pytest.raises(ParameterError, match="inner: expected an Inner"):
        Outer(inner=Outer())


@given(st.floats(0, 20), st.integers(1, 1000), st.sampled_from("ab"), st.booleans())
def test_values_survive_the_way_through_a_dict(sigma, count, rule, on):
    params = Outer(Inner(sigma, count, rule, on))
    assert Outer.from_dict(params.to_dict()) == params


def test_every_parameter_of_the_chain_says_what_it_is():
    options = list(DetectorParams.options())
    assert len({o.name for o in options}) == len(options)
    for o in options:
        assert len(o.text) >= 8, f"{o.name} has no text"
        assert o.kind is bool or o.choices or (o.low is not None and o.high is not None), (
            f"{o.name} has no range"
        )
        assert o.checked(o.default) == o.default
