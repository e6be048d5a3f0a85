"""Tables of metrics: which column shows what, and how."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Generic, NamedTuple, Self, TypeVar

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.metrics import Foot, Phase, WalkMetrics
from dogbot_logtool.report.numbers import NOTHING

S = TypeVar("S")


# Without slots, which `Column[...](...)` cannot be called with before Python 3.12.
@dataclass(frozen=True)
class Column(Generic[S]):
    """A column of a table."""

    heading: str
    of: Callable[[S], Any]
    """Takes its value from the source of a row; of an aggregate the median is shown."""
    form: str = ","
    """How a number is written."""
    scale: float = 1
    """Multiplies the number, for a unit that is easier to read."""

    def cell(self, source: S) -> str:
        """Return the value of a row as text."""
        value = self.of(source)
        value = value.median if isinstance(value, Aggregate) else value
        if value is None or isinstance(value, str):
            return value or NOTHING
        return format(value * self.scale, self.form)


class FootRow(NamedTuple):
    """The source of a foot's row."""

    foot: Foot
    phase: Phase
    load_share: float | None


def foot_rows(metrics: WalkMetrics) -> dict[str, FootRow]:
    """Return the source of each foot's row, by its name."""
    shares = metrics.forces.load_share.feet or {}
    return {
        name: FootRow(foot, metrics.gait.phase[name], shares.get(name))
        for name, foot in metrics.feet.items()
    }


class MetricPath:
    """The path of a metric, written as its attribute: ``METRICS.gait.name`` is ``gait.name``."""

    def __init__(self, *names: str) -> None:
        self._names = names

    def __getattr__(self, name: str) -> Self:
        return type(self)(*self._names, name)

    def __str__(self) -> str:
        return ".".join(self._names)


METRICS: Final = MetricPath()


def why_null(metrics: WalkMetrics, path: MetricPath) -> str:
    """Return why a metric is null, as a few words."""
    because = metrics.null_because.get(str(path), "not known")
    found = next((each.text for each in metrics.findings if each.code == because), "")
    return found.split(": ")[0] or because
