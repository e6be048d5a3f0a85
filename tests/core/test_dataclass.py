"""Our data classes behave as those of the standard library."""

import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import pytest

from dogbot_logtool.core.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Ours:
    a: int
    b: list[int] = dataclasses.field(default_factory=list, compare=False)
    c: str = "x"


@dataclasses.dataclass(frozen=True, slots=True)
class Standard:
    a: int
    b: list[int] = dataclasses.field(default_factory=list, compare=False)
    c: str = "x"


CALLS: list[Callable[[Any], Any]] = [
    lambda kind: kind(1) == kind(1, [2]),
    lambda kind: kind(1) == kind(a=1, c="y"),
    lambda kind: kind(1).__eq__((1, [], "x")),
    lambda kind: hash(kind(1)) == hash(kind(1, [2])),
    lambda kind: dataclasses.astuple(dataclasses.replace(kind(1), c="z")),
    lambda kind: dataclasses.astuple(pickle.loads(pickle.dumps(kind(1, [2], "y")))),  # noqa: S301
    lambda kind: repr(kind(1)).removeprefix(kind.__name__),
    lambda kind: kind(1).b is kind(1).b,
    lambda kind: kind(),
    lambda kind: kind(1, a=1),
    lambda kind: kind(1, [], "x", 4),
    lambda kind: kind(1, d=2),
    lambda kind: setattr(kind(1), "a", 2),
    lambda kind: delattr(kind(1), "a"),
]


def outcome(call: Callable[[Any], Any], kind: type) -> object:
    try:
        return call(kind)
    except (TypeError, AttributeError) as error:
        return type(error)


@pytest.mark.parametrize("call", CALLS)
def test_a_call_has_the_same_outcome(call: Callable[[Any], Any]) -> None:
    assert outcome(call, Ours) == outcome(call, Standard)
