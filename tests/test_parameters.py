"""Parameters of nested frozen dataclasses by dotted name."""

from dataclasses import FrozenInstanceError, dataclass, field

import pytest

from rainwind.errors import InputError
from rainwind.parameters import parameter_values, replace_parameters, unknown_name


@dataclass(frozen=True)
class Inner:
    a: float = 1.0
    b: float | None = None

    def __post_init__(self):
        if self.a < 0:
            raise InputError("inner.a must not be negative")


@dataclass(frozen=True)
class Outer:
    inner: Inner = field(default_factory=Inner)
    hidden: Inner = field(default_factory=Inner, metadata={"parameters": False})
    whole: int = 3
    text: str = "word"
    switch: bool = True
    own: float = 0.5


def test_numbers_in_the_order_of_the_fields():
    values = parameter_values(Outer())
    assert values == {"inner.a": 1.0, "whole": 3.0, "own": 0.5}
    assert list(values) == ["inner.a", "whole", "own"]
    assert all(type(value) is float for value in values.values())


def test_none_has_no_parameter_until_it_is_a_number():
    assert "inner.b" in parameter_values(Outer(inner=Inner(b=0.0)))


def test_replaced_copies_leave_the_original():
    outer = Outer()
    other = replace_parameters(outer, {"inner.a": 2.0, "inner.b": 5.0, "own": 7.0})
    assert parameter_values(other) == {"inner.a": 2.0, "inner.b": 5.0, "whole": 3.0, "own": 7.0}
    assert outer == Outer()
    with pytest.raises(FrozenInstanceError):
        other.own = 1.0
    assert replace_parameters(outer, {}) == outer


def test_the_error_names_the_whole_path():
    with pytest.raises(InputError, match=r"no parameter 'inner\.aa'\. Did you mean 'inner\.a'"):
        replace_parameters(Outer(), {"inner.aa": 1.0})


@pytest.mark.parametrize(
    "name", ["innr.a", "inner", "inner.c", "own.a", "inner.a.b", "", "none", "hidden.a", "text", "switch"]
)
def test_unknown_names_are_refused(name):
    with pytest.raises(InputError, match="there is no parameter"):
        replace_parameters(Outer(), {name: 1.0})


def test_the_dataclasses_check_the_values():
    with pytest.raises(InputError, match="must not be negative"):
        replace_parameters(Outer(), {"inner.a": -1.0})


def test_the_nearest_name_is_offered():
    message = str(unknown_name("wind.sped", ["wind.speed", "rivulet.mass"], "parameter"))
    assert (
        message
        == "there is no parameter 'wind.sped'. Did you mean 'wind.speed'? Known: wind.speed, rivulet.mass"
    )
    assert "Did you mean" not in str(unknown_name("xyz", ["wind.speed"], "parameter"))
