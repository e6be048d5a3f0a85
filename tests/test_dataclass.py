"""Data classes whose methods are generated later behave as those of the standard library."""

import copy
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace
from typing import Any, Final

import pytest

from dogbot_logtool import dataclass as ours


def record(make: Any, *, frozen: bool) -> Any:
    @make(frozen=frozen, slots=True)
    class Record:
        one: int
        many: list[int] = field(default_factory=list)
        last: float = 0.5

    return Record


def raised(call: Callable[[], object]) -> tuple[type[BaseException], str] | object:
    try:
        return call()
    except (TypeError, AttributeError) as error:
        return type(error), str(error)


USES: Final[dict[str, Callable[[Any], object]]] = {
    "repr": lambda kind: repr(kind(1)).replace(kind.__qualname__, "Record"),
    "arguments": lambda kind: (kind(1, [2], 3.0).many, kind(last=2.0, one=1).last, kind(1).many),
    "missing": lambda kind: raised(kind)[0],  # type: ignore[index] # it is raised
    "unknown": lambda kind: raised(lambda: kind(1, other=2))[0],  # type: ignore[index]
    "equal": lambda kind: (kind(1) == kind(1), kind(1) == kind(2), kind(1) == (1, [], 0.5)),
    "hash": lambda kind: raised(lambda: hash(kind(1))),
    "hashable": lambda kind: raised(lambda: hash(kind(1, (2,))) == hash(kind(1, (2,)))),
    "replaced": lambda kind: replace(kind(1), one=2).one,
    "fields": lambda kind: [each.name for each in fields(kind)],
    "no other attributes": lambda kind: hasattr(kind(1), "__dict__"),
    "copied": lambda kind: copy.deepcopy(kind(1, [2])).many,
    "shared": lambda kind: kind(1).many is kind(1).many,
}


@pytest.mark.parametrize("frozen", [True, False])
@pytest.mark.parametrize("use", USES)
def test_same_as_the_standard_library(use: str, *, frozen: bool) -> None:
    expected = USES[use](record(dataclass, frozen=frozen))
    assert USES[use](record(ours.dataclass, frozen=frozen)) == expected


def test_frozen_fields_keep_their_values() -> None:
    one = record(ours.dataclass, frozen=True)(1)
    with pytest.raises(FrozenInstanceError, match="one"):
        one.one = 2
    with pytest.raises(FrozenInstanceError, match="one"):
        del one.one
    changed = record(ours.dataclass, frozen=False)(1)
    changed.one = 2
    assert (one.one, changed.one) == (1, 2)


@ours.dataclass(frozen=True, slots=True)
class Parent:
    one: int

    def __repr__(self) -> str:
        return f"<{self.one}>"


@ours.dataclass(frozen=True, slots=True)
class Child(Parent):
    two: int = 2


def test_methods_of_its_own_are_kept() -> None:
    assert repr(Parent(1)) == "<1>"


def test_what_follows_the_initialiser_is_called() -> None:
    @ours.dataclass(slots=True)
    class Doubled:
        one: int
        two: int = field(init=False)

        def __post_init__(self) -> None:
            self.two = 2 * self.one

    assert Doubled(3).two == 6


def test_a_child_has_the_fields_of_its_parent() -> None:
    assert (Child(1), Child(1).two) == (Child(1, 2), 2)
    assert Child(1) != Parent(1)


@pytest.mark.parametrize("one", [Parent(1), Child(3, 4)])
def test_pickled(one: Parent) -> None:
    assert pickle.loads(pickle.dumps(one)) == one  # noqa: S301 - our own
