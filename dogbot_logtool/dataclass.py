"""Data classes as the standard library makes them, at a twentieth of the cost at import.

Python 3.11 compiles six methods of each data class on their own. Here they are closures over the
names of the fields, which are nearly as fast when they are called.
"""

import dataclasses
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final, TypeVar

C = TypeVar("C")

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass  # noqa: PLC0414 - checkers know this one
else:

    def dataclass(*, frozen: bool = False, slots: bool = False) -> Callable[[type[C]], type[C]]:
        """Make a class a data class; see `dataclasses.dataclass`."""

        def decorate(cls: type[C]) -> type[C]:
            own = set(vars(cls))
            # Without one, the standard library works out a signature for it.
            cls.__doc__ = cls.__doc__ or cls.__name__
            made = dataclasses.dataclass(init=False, repr=False, eq=False, slots=slots)(cls)
            methods = {"__init__": _initialiser(made), "__repr__": _repr}
            methods |= {"__eq__": _equality(made), "__hash__": _hash(made)}
            if frozen:
                made.__setattr__ = made.__delattr__ = _refuse_change
                made.__getstate__, made.__setstate__ = _state, _restore
            else:
                methods["__hash__"] = None
            for name in methods.keys() - own:
                setattr(made, name, methods[name])
            return made

        return decorate


def _initialiser(cls: Any) -> Callable[..., None]:  # noqa: ANN401 - any data class
    fields = [f for f in dataclasses.fields(cls) if f.init]
    names = dict.fromkeys(f.name for f in fields)
    defaults = {f.name: f.default for f in fields if f.default is not dataclasses.MISSING}
    factories = {
        f.name: f.default_factory for f in fields if f.default_factory is not dataclasses.MISSING
    }
    is_finished_later = hasattr(cls, "__post_init__")

    def complete(args: tuple[object, ...], values: dict[str, object]) -> dict[str, object]:
        count = len(args) + len(values)
        if args:
            values.update(zip(names, args))  # noqa: B905 - counted below
        if len(values) < count:
            raise TypeError(f"{cls.__qualname__}: too many values, or one of them twice")
        if count < len(names):
            made = {name: make() for name, make in factories.items() if name not in values}
            values = {**defaults, **made, **values}
        if values.keys() != names.keys():
            wrong = ", ".join(sorted(values.keys() ^ names.keys()))
            raise TypeError(f"{cls.__qualname__}: missing or unknown: {wrong}")
        return values

    def __init__(self: Any, *args: object, **values: object) -> None:  # noqa: ANN401, N807
        by_position = len(args) == len(names) and not values
        given = zip(names, args) if by_position else complete(args, values).items()  # noqa: B905
        for name, value in given:
            _set(self, name, value)
        if is_finished_later:
            self.__post_init__()

    return __init__


def _equality(cls: Any) -> Callable[[Any, object], Any]:  # noqa: ANN401 - any data class
    values = _values_of([f.name for f in dataclasses.fields(cls) if f.compare])

    def __eq__(self: Any, other: object) -> Any:  # noqa: ANN401, N807
        return values(self) == values(other) if type(other) is type(self) else NotImplemented

    return __eq__


def _hash(cls: Any) -> Callable[[Any], int]:  # noqa: ANN401 - any data class
    fields = dataclasses.fields(cls)
    values = _values_of([f.name for f in fields if (f.compare if f.hash is None else f.hash)])
    return lambda self: hash(values(self))


def _values_of(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    if len(names) > 1:
        return attrgetter(*names)
    return lambda record: tuple(getattr(record, name) for name in names)


_set: Final = object.__setattr__


def _repr(self: Any) -> str:  # noqa: ANN401 - any record
    shown = (f"{f.name}={getattr(self, f.name)!r}" for f in dataclasses.fields(self) if f.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _refuse_change(self: object, name: str, *_value: object) -> None:
    raise dataclasses.FrozenInstanceError(f"{name!r} of {type(self).__name__} cannot be changed")


def _state(self: Any) -> list[Any]:  # noqa: ANN401 - any record
    """Return what is pickled."""
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _restore(self: Any, state: list[Any]) -> None:  # noqa: ANN401 - any record
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        _set(self, field.name, value)
