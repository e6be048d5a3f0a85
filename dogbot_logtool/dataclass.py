"""Data classes as the standard library makes them, at a twentieth of the cost at import.

Python 3.11 compiles six methods of each data class on their own. Here they are shared by all
classes, or compiled when they are first called; most never are.
"""

import dataclasses
from collections.abc import Callable
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
            methods = {name: _compiled_later(made, name) for name in _SOURCES}
            methods["__repr__"] = _repr
            if frozen:
                made.__setattr__ = made.__delattr__ = _refuse_change
                made.__getstate__, made.__setstate__ = _state, _restore
            else:
                methods["__hash__"] = None
            for name in methods.keys() - own:
                setattr(made, name, methods[name])
            return made

        return decorate


def _compiled_later(cls: type, name: str) -> Callable[..., Any]:
    """Return a method that puts the compiled one in its place when it is first called."""

    def method(*args: object, **values: object) -> Any:  # noqa: ANN401 - any method
        known: dict[str, Any] = {}
        exec(_SOURCES[name](cls, known), known)  # noqa: S102 - names of fields are Python's own
        compiled = known[name]
        compiled.__qualname__ = f"{cls.__qualname__}.{name}"
        setattr(cls, name, compiled)
        return compiled(*args, **values)

    return method


def _initialiser(cls: Any, known: dict[str, Any]) -> str:  # noqa: ANN401 - any data class
    """Write a function that sets the fields; what it needs to know is added to `known`."""
    known["_set"], known["_unset"] = object.__setattr__, dataclasses.MISSING
    words, lines = ["self"], ["pass"]
    for number, field in enumerate(dataclasses.fields(cls)):
        name, value = field.name, field.name
        if field.default is not dataclasses.MISSING:
            known[f"_{number}"] = field.default
            words.append(f"{name}=_{number}")
        elif field.default_factory is not dataclasses.MISSING:
            known[f"_{number}"] = field.default_factory
            words.append(f"{name}=_unset")
            value = f"_{number}() if {name} is _unset else {name}"
        elif field.init:
            words.append(name)
        else:
            continue
        lines.append(f"_set(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    return f"def __init__({', '.join(words)}):\n  " + "\n  ".join(lines)


def _equality(cls: Any, _known: dict[str, Any]) -> str:  # noqa: ANN401 - any data class
    names = [field.name for field in dataclasses.fields(cls) if field.compare]
    same = f"{_tuple('self', names)} == {_tuple('other', names)}"
    return (
        f"def __eq__(self, other):\n"
        f"  return {same} if type(other) is type(self) else NotImplemented"
    )


def _hash(cls: Any, _known: dict[str, Any]) -> str:  # noqa: ANN401 - any data class
    fields = dataclasses.fields(cls)
    names = [f.name for f in fields if (f.compare if f.hash is None else f.hash)]
    return f"def __hash__(self):\n  return hash({_tuple('self', names)})"


def _tuple(owner: str, names: list[str]) -> str:
    return f"({''.join(f'{owner}.{name}, ' for name in names)})"


_SOURCES: Final = {"__init__": _initialiser, "__eq__": _equality, "__hash__": _hash}


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
        object.__setattr__(self, field.name, value)
