"""Tables of metrics: how numbers are written, which column shows what; strides; tables as files."""

import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import PurePath
from typing import Any, BinaryIO, Final, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Aggregate, Floats
from dogbot_logtool.core.checks.engine import void_columns
from dogbot_logtool.core.contact.stances import Cut
from dogbot_logtool.core.gait.feet import FIGURES
from dogbot_logtool.core.metrics import Foot, Phase, Stride, WalkMetrics
from dogbot_logtool.core.records import MetricPath, fields_of
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import CallError, ExtraMissingError
from dogbot_logtool.io.printable import printable
from dogbot_logtool.results import StrideTable

NOTHING: Final = "-"
"""Stands for a metric that is not known."""
_SIMULATED_BEFORE_S: Final = 1_000_000_000
"""Log times before this are simulation time, not dates."""
_NEVER_S: Final = 3e10
Columns = Mapping[str, NDArray[Any]]
"""(n,) each: float64, bool, or texts and None as objects."""


def decimal(value: float | None, decimals: int) -> str:
    """Write a number with a fixed number of decimals."""
    return NOTHING if value is None else f"{value:z.{decimals}f}"


def recorded_at(time_s: float | None) -> str:
    """Write a log time, s since the epoch, as a date in UTC; clocks of simulators begin in 1970."""
    if time_s is None:
        return "not known"
    if not _SIMULATED_BEFORE_S <= time_s < _NEVER_S:
        return f"{time_s:.3f} s (simulation time)"
    return f"{datetime.fromtimestamp(time_s, UTC):%Y-%m-%d %H:%M:%S} UTC"


def span_of(values: Sequence[float]) -> str:
    """Write the lowest and the highest of some numbers; once, where they are the same."""
    written = list(dict.fromkeys(f"{value:.3g}" for value in sorted(values)))
    return " to ".join([written[0], *written[1:][-1:]]) if written else NOTHING


def nice_step(least: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least as large."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least)


S = TypeVar("S")


# Without slots, which `Column[...](...)` cannot be called with before Python 3.12.
@dataclass(frozen=True, eq=False, repr=False)
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


def why_null(metrics: WalkMetrics, path: MetricPath) -> str:
    """Return why a metric is null, as a few words."""
    because = metrics.null_because.get(str(path), "not known")
    found = next((each.text for each in metrics.findings if each.code == because), "")
    return found.split(": ")[0] or because


def stride_table(walk: Walk) -> StrideTable:
    """Gather the strides of all feet; what findings void is NaN."""
    feet = [
        void_columns(_strides_of(walk, row), foot.name, walk.findings)
        for row, foot in enumerate(walk.feet)
    ]
    columns = {each.name: _joined([foot[each.name] for foot in feet]) for each in fields_of(Stride)}
    names = [foot.name for foot in walk.feet for _ in foot.strides.stance]
    return StrideTable(tuple(names), columns)


def _strides_of(walk: Walk, row: int) -> Mapping[str, Floats]:
    """Return the metrics of each stride of a foot, (strides,) by name; NaN where not known."""
    foot = walk.feet[row]
    strides, stances = foot.strides, foot.stances.figures
    columns = {
        **foot.of_strides,
        "start_s": (strides.touchdown - walk.origin) / 1e9,
        "stance_s": strides.stance_s,
        "length_m": foot.length_m,
        "peak_force_n": stances.peak_force_n[strides.stance],
        "vertical_impulse_ns": stances.vertical_impulse_ns[strides.stance],
        "slip_m": foot.of_stances["slip_m"][strides.stance],
    }
    unknown = np.full(len(strides.stance), np.nan)
    found = {each.name: columns.get(each.name, unknown) for each in fields_of(Stride)}
    # One NaN for all: tables are compared to the bit.
    return {name: np.where(np.isnan(each), np.nan, each) for name, each in found.items()}


def stance_columns(walk: Walk) -> Columns:
    """Gather the stances of all feet; what findings void is NaN."""
    stances = [foot.stances for foot in walk.feet]
    figures = [
        void_columns(
            {n: getattr(foot.stances.figures, n) for n in FIGURES}, foot.name, walk.findings
        )
        for foot in walk.feet
    ]
    names = [foot.name for foot in walk.feet for _ in foot.stances.touchdown]
    cuts = [Cut(cut) for each in stances for cut in each.cut.tolist()]
    return {
        "foot": np.array(names, np.object_),
        "touchdown_s": _joined([(each.touchdown - walk.origin) / 1e9 for each in stances]),
        "lift_off_s": _joined([(each.liftoff - walk.origin) / 1e9 for each in stances]),
        "cut": np.array([cut.name.lower() if cut else "" for cut in cuts], np.object_),
        **{name: _joined([each[name] for each in figures]) for name in FIGURES},
    }


def _joined(columns: Sequence[Floats]) -> Floats:
    """Return columns of several feet as one, (n,)."""
    return np.concatenate([np.empty(0), *columns])


SUFFIXES: Final = (".csv", ".parquet", ".arrow", ".feather")
_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r")


def arrow_table(columns: Columns) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return a `pyarrow.Table`; NaN is null there.

    Raises:
        ImportError: pyarrow is not installed.
    """
    import pyarrow as pa  # noqa: PLC0415 - takes longer than everything else

    texts = {name: pa.string() for name, each in columns.items() if each.dtype == np.object_}
    return pa.table(
        {
            name: pa.array(column, type=texts.get(name), from_pandas=True)
            for name, column in columns.items()
        }
    )


class TableFile:
    """Takes the rows of a table piece by piece; all pieces have the same columns."""

    def __init__(self, name: str, file: BinaryIO) -> None:
        """Choose the format that a name tells.

        Raises:
            CallError: it tells none.
            ExtraMissingError: what writes it is not installed.
        """
        self._file = file
        self._suffix: Final = PurePath(name).suffix.lower()
        self._writer: Any = None
        if self._suffix not in SUFFIXES:
            raise CallError(f"{name}: must end in {', '.join(SUFFIXES)}")
        if self._suffix != ".csv":
            try:
                import pyarrow  # noqa: F401, ICN001, PLC0415
            except ImportError as error:
                raise ExtraMissingError(name, "fleet") from error

    def add(self, columns: Columns) -> None:
        """Write rows."""
        is_first = self._writer is None
        if self._suffix != ".csv":
            rows = arrow_table(columns)
            self._writer = self._opened(rows.schema) if is_first else self._writer
            self._writer.write_table(rows)
            return
        import csv  # noqa: PLC0415 - most commands write no table

        text = io.StringIO()
        self._writer = csv.writer(text, lineterminator="\n")
        if is_first:
            self._writer.writerow(columns)
        # Numbers have all their digits; what is not known is empty.
        self._writer.writerows(zip(*map(_cells, columns.values()), strict=True))
        self._file.write(text.getvalue().encode())

    def finish(self) -> None:
        """Write what stands at the end of the file."""
        if self._writer is not None and self._suffix != ".csv":
            self._writer.close()

    def _opened(self, schema: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
        import pyarrow as pa  # noqa: PLC0415
        import pyarrow.parquet as pq  # noqa: PLC0415

        if self._suffix == ".parquet":
            return pq.ParquetWriter(self._file, schema, compression="zstd")
        options = pa.ipc.IpcWriteOptions(compression="zstd")
        return pa.ipc.new_file(self._file, schema, options=options)


def _cells(column: NDArray[Any]) -> list[Any]:
    """Return the cells of a column."""
    values = column.tolist()
    if column.dtype == np.object_:
        return ["" if value is None else _text_cell(value) for value in values]
    if column.dtype == np.bool_:
        return ["true" if value else "false" for value in values]
    return ["" if value != value else value for value in values]  # noqa: PLR0124 - NaN


def _text_cell(text: str) -> str:
    """Return the text of a cell, with an apostrophe before what spreadsheets take for a formula."""
    safe = printable(text)
    return f"'{safe}" if text.startswith(_FORMULA) else safe
