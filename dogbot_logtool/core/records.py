"""Records whose fields describe themselves: JSON, paths, and setting to null.

    @dataclass(frozen=True, slots=True, eq=False, repr=False)
    class Foot(Record):
        swing_s: Annotated[Spread, Of("s", "contact", "strides")]
        \"\"\"Lift-off to touchdown.\"\"\"

The field's name is the key, the string below it its definition, its annotation says type, unit and
what a log must hold for it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from fnmatch import fnmatchcase
from functools import cache
from typing import Annotated, Any, Final, NamedTuple, Self, TypeVar, get_args, get_origin

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.definitions import definitions

R = TypeVar("R", bound=Any)
Json = dict[str, Any]


class Of:
    """Unit of a metric, and what a log must hold for it."""

    __slots__ = ("needs", "unit")

    def __init__(self, unit: str = "", *needs: str) -> None:
        self.unit: Final = unit
        self.needs: Final = needs


class Record:
    """A record of metrics, which can be printed and compared.

    Here once: made for each of thirty data classes these methods are 3 % of a short log's time.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        values = ", ".join(f"{each.name}={getattr(self, each.name)!r}" for each in fields(self))  # type: ignore[arg-type]
        return f"{type(self).__name__}({values})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            getattr(self, each.name) == getattr(other, each.name)
            for each in fields(self)  # type: ignore[arg-type]
        )

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Curve:
    """Quartiles over the gait cycle, touchdown to the next touchdown."""

    percent: tuple[float, ...]
    """Of the stride."""
    lower: tuple[float, ...]
    """Lower quartile over strides."""
    median: tuple[float, ...]
    """Median over strides."""
    upper: tuple[float, ...]
    """Upper quartile over strides."""


Number = float | None
Count = int | None
Text = str | None
Spread = Aggregate | None
Shape = Curve | None
Numbers = tuple[float, ...] | None
LEAVES: Final[Mapping[type, str]] = {Aggregate: "aggregate", Curve: "curve"}


class Field(NamedTuple):
    """A field of a record."""

    name: str
    kind: str
    """scalar, aggregate, curve, list; record, records (a list of them), map (by name)."""
    inner: Any
    """Its type, or that of its items, without ``None``."""
    nullable: bool
    of: Of

    @property
    def is_detail(self) -> bool:
        """Whether it is long: a curve or a list of times."""
        return self.kind == "curve" or (self.kind == "list" and self.of.unit == "s")


def is_record(kind: Any) -> bool:  # noqa: ANN401 - any type
    """Tell whether a type is a record of metrics, not a single value of several numbers."""
    return is_dataclass(kind) and kind not in LEAVES


def fields_of(record: Any) -> tuple[Field, ...]:  # noqa: ANN401 - any record
    """List the fields of a type of records, in the order in which they are declared."""
    return _fields_of(record)


@cache
def _fields_of(record: Any) -> tuple[Field, ...]:  # noqa: ANN401 - any record
    return tuple(_field(each.name, each.type) for each in fields(record))


def _field(name: str, hint: Any) -> Field:  # noqa: ANN401 - any annotation
    of = next((each for each in getattr(hint, "__metadata__", ()) if isinstance(each, Of)), Of())
    bare = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    nullable = type(None) in get_args(bare)
    inner = next(each for each in get_args(bare) if each is not type(None)) if nullable else bare
    if get_origin(inner) is dict:
        return Field(name, "map", get_args(inner)[1], nullable, of)
    if get_origin(inner) is tuple:
        item = get_args(inner)[0]
        return Field(name, "records" if is_record(item) else "list", item, nullable, of)
    kind = LEAVES.get(inner, "record" if is_record(inner) else "scalar")
    return Field(name, kind, inner, nullable, of)


def metric_paths(record: Any, prefix: str = "") -> Iterator[tuple[str, Field, str]]:  # noqa: ANN401
    """Yield path, field and definition of every metric of a type of records.

    In paths ``*`` stands for a name, ``[]`` for the items of a list.
    """
    words = definitions(record)
    for field in fields_of(record):
        path = prefix + field.name
        items = {"records": "[]", "map": ".*"}.get(field.kind, "")
        if is_record(field.inner):
            yield from metric_paths(field.inner, f"{path}{items}.")
        else:
            yield path + items, field, words.get(field.name, "")


KeyPath = tuple[str, ...]
"""Names of fields, keys and places in lists that lead to a value."""


def values(record: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any, Field]]:  # noqa: ANN401
    """Yield path, value and field of the metrics that a record holds."""
    for field in fields_of(type(record)):
        value, here = getattr(record, field.name), (*path, field.name)
        items = [(here, value)]
        if field.kind == "map" and value is not None:
            items = [((*here, name), each) for name, each in value.items()]
        elif field.kind == "records" and value is not None:
            items = [((*here, str(number)), each) for number, each in enumerate(value)]
        for key, each in items:
            if is_record(type(each)):
                yield from values(each, key)
            else:
                yield key, each, field


def void(record: R, patterns: Sequence[str], prefix: str = "") -> R:
    """Set the metrics that match patterns, such as ``feet.*.slip_m``, to null.

    A star also stands for several names: ``feet.left.*`` are all metrics of that foot. Records in a
    list that hold records, which segments are, have the same groups of metrics as the whole log.
    """
    changes: Json = {}
    for field in fields_of(type(record)):
        value, path = getattr(record, field.name), prefix + field.name
        if field.nullable and any(fnmatchcase(path, each) for each in patterns):
            changes[field.name] = None
        elif field.kind == "record" and value is not None:
            changes[field.name] = void(value, patterns, path + ".")
        elif field.kind == "map" and value and is_record(field.inner):
            changes[field.name] = {
                name: void(each, patterns, f"{path}.{name}.") for name, each in value.items()
            }
        elif field.kind == "records" and any(f.kind == "record" for f in fields_of(field.inner)):
            changes[field.name] = tuple(void(each, patterns) for each in value)
    changed: R = replace(record, **changes)
    return changed


def copied(record: type[R], source: Any, **others: Any) -> R:  # noqa: ANN401
    """Return a record whose fields have the values of attributes of the same names."""
    names = {field.name for field in fields_of(record)} - others.keys()
    made: R = record(**{name: getattr(source, name) for name in names}, **others)
    return made


def unknown(record: type[R]) -> R:
    """Return a record in which nothing is measured: null, 0 or empty."""
    made: R = record(**{field.name: _unknown(field) for field in fields_of(record)})
    return made


def _unknown(field: Field) -> Any:  # noqa: ANN401 - any value
    if field.nullable:
        return None
    if field.kind == "record":
        return unknown(field.inner)
    return {"map": dict, "list": tuple, "records": tuple}.get(field.kind, field.inner)()


def to_json(value: Any, *, detail: bool = True) -> Any:  # noqa: ANN401 - JSON
    """Return what `json.dumps` takes; without detail, curves and lists of times are left out."""
    if is_dataclass(type(value)):
        return {
            field.name: to_json(getattr(value, field.name), detail=detail)
            for field in fields_of(type(value))
            if detail or not field.is_detail
        }
    if isinstance(value, dict):
        return {name: to_json(each, detail=detail) for name, each in value.items()}
    return [to_json(each, detail=detail) for each in value] if isinstance(value, tuple) else value


class MetricPath:
    """The path of a metric, written as its attribute: ``METRICS.gait.name`` is ``gait.name``."""

    def __init__(self, *names: str) -> None:
        self._names = names

    def __getattr__(self, name: str) -> Self:
        return type(self)(*self._names, name)

    def __getitem__(self, name: str) -> Self:
        """Return the path of a foot, a joint, a topic ...; ``*`` stands for all."""
        return type(self)(*self._names, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __str__(self) -> str:
        return ".".join(self)

    def value_in(self, document: Mapping[str, Any]) -> Any:  # noqa: ANN401 - any value of JSON
        """Return the metric in a JSON object; None where that, or what holds it, is null."""
        value: Any = document
        for name in self:
            value = None if value is None else value.get(name)
        return value


METRICS: Final = MetricPath()
