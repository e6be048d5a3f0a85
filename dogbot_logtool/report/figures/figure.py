"""Rows of the table of figures, and their plain data."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import Enum, auto
from typing import Any, Final, Generic, TypeVar

from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.dataclass import dataclass

UNITS: Final[Mapping[str, str]] = {
    "bw": "body weights",
    "bytes": "bytes",
    "counts": "counts",
    "hz": "1/s",
    "j": "J",
    "kg": "kg",
    "m": "m",
    "mps": "m/s",
    "mps2": "m/s^2",
    "n": "N",
    "nps": "N/s",
    "ns": "N s",
    "percent": "%",
    "ppm": "1e-6",
    "rad": "rad",
    "radps": "rad/s",
    "s": "s",
}
"""Units by the ends of keys, such as ``stance_s``."""
S_contra = TypeVar("S_contra", contravariant=True)
Json = dict[str, Any]


class Kind(Enum):
    """Type of a figure in JSON."""

    NUMBER = auto()
    AMOUNT = auto()
    """A number, never below 0."""
    FRACTION = auto()
    """A number from 0 to 1."""
    INTEGER = auto()
    COUNT = auto()
    """An integer, never below 0."""
    FLAG = auto()
    TEXT = auto()
    AGGREGATE = auto()
    """An `Aggregate`: n, mean, std, median, min and max of many values."""
    NUMBERS = auto()
    """A list of numbers."""
    TEXTS = auto()
    """A list of texts."""
    COUNTS_BY_NAME = auto()
    NUMBERS_BY_NAME = auto()
    FRACTIONS_BY_NAME = auto()
    COLUMN = auto()
    """(n,) numbers, one for each row of a table; not in JSON."""


BY_NAME: Final = (Kind.COUNTS_BY_NAME, Kind.NUMBERS_BY_NAME, Kind.FRACTIONS_BY_NAME)


class TableName(Enum):
    """A table that has figures as columns."""

    STEPS = "steps of each foot, in the terminal and on the page"
    LOADS = "loads of each foot in the terminal"
    PAGE_LOADS = "loads of each foot on the page"
    PAGE_STRIDES = "strides on the page"
    LEGS = "legs of each foot, in the terminal and on the page"
    JOINTS = "joints, in the terminal and on the page"
    TOPICS = "topics on the page"
    SYMMETRY = "right against left on the page"
    SUMMARY = "several logs in the terminal"
    INDEX = "several logs on the page"
    LOG_ROWS = "logs in Parquet"


@dataclass(frozen=True, slots=True)
class Column:
    """How a table shows a figure."""

    table: TableName
    header: str
    decimals: int | None = None
    """None: as it is."""
    rank: int = 100
    """Columns are sorted by this; those of one rank keep the order of the rows."""
    scale: float = 1.0
    """Multiplies the value, for a unit that is easier to read."""
    statistic: str = "median"
    """Member of an aggregate that is shown."""
    percent: bool = False
    """Whether a fraction is shown in percent."""
    thousands: bool = False
    """Whether a count is shown with commas."""
    signed: bool = False
    """Whether a number is shown with its sign, also above 0."""


# Without slots, which `Figure[...](...)` cannot be called with before Python 3.12.
@dataclass(frozen=True)
class Figure(Generic[S_contra]):
    """One figure: a row of the table."""

    key: str
    """Its key in JSON, or its name as a column of CSV and Parquet; `unit_of` it is its unit."""
    kind: Kind
    of: Callable[[S_contra], Any]
    """Takes it from a record of the core."""
    definition: str
    """Definition: formula and, if there is one, its source."""
    null: str = ""
    """When it is not known; empty: it always is."""
    choices: tuple[str | int, ...] = ()
    """All values that it may have; empty: any."""
    columns: tuple[Column, ...] = ()
    """The tables that show it."""
    unit: str = ""
    """Only where the key does not end in it; empty otherwise, and for figures without one."""

    def __post_init__(self) -> None:
        """Take the unit from the key."""
        object.__setattr__(self, "unit", self.unit or unit_of(self.key))

    def plain(self, source: S_contra) -> Any:  # noqa: ANN401 - JSON
        """Return the value as plain data."""
        value = self.of(source)
        return aggregate_json(value) if isinstance(value, Aggregate) else value


def unit_of(key: str) -> str:
    """Return the unit that a key ends in; empty: none."""
    _, underscore, end = key.rpartition("_")
    return UNITS.get(end, "") if underscore else ""


class Shape(Enum):
    """How often the figures of a scope are given."""

    ONCE = auto()
    BY_NAME = auto()
    """An object of objects: of each foot or topic."""
    LIST = auto()


@dataclass(frozen=True, slots=True)
class Scope:
    """Figures of one thing: an object in JSON."""

    key: str
    members: "Sequence[Figure[Any] | Scope]"
    of: Callable[[Any], Any]
    """Takes the record, the mapping or the sequence of records that the members are taken from."""
    definition: str
    null: str = ""
    """When there is none; empty: there always is."""
    shape: Shape = Shape.ONCE
    null_items: str = ""
    """When one of the named has no figures; empty: all have."""

    def plain(self, source: Any) -> Any:  # noqa: ANN401 - JSON
        """Return the figures as plain data."""
        found = self.of(source)
        if found is None:
            return None
        if self.shape is Shape.BY_NAME:
            return {name: self._object(each) for name, each in found.items()}
        if self.shape is Shape.LIST:
            return [self._object(each) for each in found]
        return self._object(found)

    def _object(self, source: Any) -> Json | None:  # noqa: ANN401 - any record
        if source is None:
            return None
        return {member.key: member.plain(source) for member in self.members}


Member = Figure[Any] | Scope


def points(
    key: str, of: Callable[[S_contra], Floats | None], definition: str, unit: str, null: str = ""
) -> Figure[S_contra]:
    """Return a figure of the points of a curve."""

    def plain(source: S_contra) -> list[float] | None:
        found = of(source)
        return None if found is None else found.tolist()

    return Figure(key, Kind.NUMBERS, plain, definition, null, unit=unit)


def inside(
    members: Sequence[Member], part: Callable[[Any], Any], null: str = ""
) -> tuple[Member, ...]:
    """Return figures of a part as figures of the whole, null where there is no such part.

    Args:
        members: figures of the part.
        part: takes the part from the whole; None where there is none.
        null: when there is none; empty: there always is.
    """

    def through(of: Callable[[Any], Any]) -> Callable[[Any], Any]:
        return lambda whole: None if (source := part(whole)) is None else of(source)

    return tuple(
        replace(each, of=through(each.of), null="; ".join(filter(None, (null, each.null))))
        for each in members
    )


def aggregate_json(value: Aggregate) -> Json:
    """Return an aggregate as plain data."""
    return {name: getattr(value, name) for name in STATISTICS}


STATISTICS: Final[Mapping[str, str]] = {
    "n": "number of values",
    "mean": "their mean",
    "std": "their sample standard deviation (divisor n - 1); null for a single value",
    "median": "their median",
    "min": "the lowest",
    "max": "the highest",
}
"""Members of an aggregate."""


def scaled(value: Aggregate | None, factor: float | None) -> Aggregate | None:
    """Return an aggregate in another unit; None where the factor is not known."""
    if value is None or factor is None:
        return None
    return Aggregate(
        n=value.n,
        mean=value.mean * factor,
        std=None if value.std is None else value.std * factor,
        median=value.median * factor,
        min=value.min * factor,
        max=value.max * factor,
    )


_ITEMS: Final = {Shape.ONCE: "", Shape.BY_NAME: ".*", Shape.LIST: "[]"}


def all_figures(scope: Scope, path: str = "") -> Iterator[tuple[str, Figure[Any]]]:
    """Yield every figure below a scope with its path.

    In paths ``*`` stands for the name of a foot or topic, and ``[]`` for the items of a list.
    """
    for member in scope.members:
        below = f"{path}.{member.key}" if path else member.key
        if isinstance(member, Scope):
            yield from all_figures(member, below + _ITEMS[member.shape])
        else:
            yield below + (".*" if member.kind in BY_NAME else ""), member
