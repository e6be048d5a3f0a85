"""Data classes as the standard library makes them, whose methods are generated when first used.

Python 3.11 compiles every method of a data class on its own: 20 times the cost of the class itself.
A command loads two hundred records and makes instances of half of them.
"""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeVar

C = TypeVar("C")
_METHODS: Final = ("__init__", "__repr__", "__eq__", "__hash__")

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass  # noqa: PLC0414 - checkers know this one
else:

    def dataclass(*, frozen: bool = False, slots: bool = False) -> Callable[[type[C]], type[C]]:
        """Make a class a data class; see `dataclasses.dataclass`."""

        def decorate(cls: type[C]) -> type[C]:
            own = set(vars(cls))
            made = dataclasses.dataclass(init=False, repr=False, eq=False, slots=slots)(cls)
            missing = [name for name in _METHODS if name not in own]
            for name in missing:
                setattr(made, name, _generated_later(made, name, missing, frozen=frozen))
            if frozen:
                made.__setattr__ = made.__delattr__ = _refuse_change
                made.__getstate__, made.__setstate__ = _state, _restore
            return made

        return decorate


def _generated_later(
    cls: type, name: str, missing: list[str], *, frozen: bool
) -> Callable[..., Any]:
    """Return a method that puts the generated ones in place and then calls its own."""

    def method(self: object, *args: object, **values: object) -> Any:  # noqa: ANN401 - any method
        fields = [(field.name, field.type, field) for field in dataclasses.fields(cls)]
        after = {key: value for key in ["__post_init__"] if (value := getattr(cls, key, None))}
        full = dataclasses.make_dataclass(cls.__name__, fields, namespace=after, frozen=frozen)
        for each in missing:
            setattr(cls, each, getattr(full, each))
        return getattr(cls, name)(self, *args, **values)

    return method


def _refuse_change(self: object, name: str, *_value: object) -> None:
    raise dataclasses.FrozenInstanceError(f"{name!r} of {type(self).__name__} cannot be changed")


def _state(self: Any) -> list[Any]:  # noqa: ANN401 - any record
    """Return what is pickled."""
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _restore(self: Any, state: list[Any]) -> None:  # noqa: ANN401 - any record
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)
