"""Tables as files and in memory: CSV, Parquet and Arrow, and the strides of a log among them."""

import csv
import io
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from types import MappingProxyType
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.checks.voids import void_columns
from dogbot_logtool.core.legs.swings import STEPS, SWINGS
from dogbot_logtool.core.metrics import Stride
from dogbot_logtool.core.records import fields_of
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import CallError, ExtraMissingError
from dogbot_logtool.io.printable import printable
from dogbot_logtool.results import StrideTable


def stride_table(stats: Walk, void: Sequence[str] = ()) -> StrideTable:
    """Gather the strides of all feet.

    Args:
        stats: what was worked out of a log.
        void: patterns of metrics that are void.
    """
    names = [foot.name for foot in stats.feet for _ in foot.strides.stance]
    feet = [foot_strides(stats, row, void) for row in range(len(stats.feet))]
    columns = {
        field.name: np.concatenate([np.empty(0), *(foot[field.name] for foot in feet)])
        for field in fields_of(Stride)
    }
    return StrideTable(tuple(names), columns)


def foot_strides(stats: Walk, row: int, void: Sequence[str] = ()) -> Mapping[str, Floats]:
    """Return the metrics of each stride of a foot, (strides,) by name; NaN where not known."""
    foot = stats.feet[row]
    strides, figures = foot.strides, foot.stances.figures
    columns = {
        "start_s": (strides.touchdown - stats.origin) / 1e9,
        "stance_s": strides.stance_s,
        "swing_s": strides.swing_s,
        "duty_factor": strides.duty_factor,
        "length_m": foot.length_m,
        "peak_force_n": figures.peak_force_n[strides.stance],
        "vertical_impulse_ns": figures.vertical_impulse_ns[strides.stance],
        "slip_m": foot.slip_m[strides.stance],
    }
    legs = stats.legs
    unknown = np.full(len(strides.stance), np.nan)
    for name in _OF_LEG:
        found = unknown if legs is None else legs.feet[row].strides[name]
        # One NaN for all: tables are compared to the bit.
        columns[name] = np.where(np.isnan(found), np.nan, found)
    return void_columns(columns, foot.name, void)


_OF_LEG: Final = (*SWINGS, *STEPS, "positive_work_j", "absolute_work_j")
"""Metrics of a stride that its leg tells."""


_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r")

Columns = Mapping[str, NDArray[Any]]
"""(n,) each: float64, bool, or texts and None as objects."""


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


class TableFile(ABC):
    """Takes the rows of a table piece by piece; all pieces have the same columns."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    @abstractmethod
    def add(self, columns: Columns) -> None:
        """Write rows."""

    def finish(self) -> None:  # noqa: B027 - not all have an end
        """Write what stands at the end of the file."""


class _CsvFile(TableFile):
    """Numbers have all their digits; what is not known is empty."""

    _begun = False

    def add(self, columns: Columns) -> None:
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        if not self._begun:
            writer.writerow(columns)
            self._begun = True
        writer.writerows(zip(*map(_cells, columns.values()), strict=True))
        self._file.write(text.getvalue().encode())


class _ParquetFile(TableFile):
    def __init__(self, file: BinaryIO) -> None:
        super().__init__(file)
        self._writer: Any = None

    def add(self, columns: Columns) -> None:
        table = arrow_table(columns)
        if self._writer is None:
            self._writer = self._open(table.schema)
        self._writer.write_table(table)

    def finish(self) -> None:
        if self._writer is not None:
            self._writer.close()

    def _open(self, schema: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
        import pyarrow.parquet as pq  # noqa: PLC0415

        return pq.ParquetWriter(self._file, schema, compression="zstd")


class _ArrowFile(_ParquetFile):
    def _open(self, schema: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
        import pyarrow as pa  # noqa: PLC0415

        options = pa.ipc.IpcWriteOptions(compression="zstd")
        return pa.ipc.new_file(self._file, schema, options=options)


_FORMS: Final[Mapping[str, type[TableFile]]] = MappingProxyType(
    {
        ".csv": _CsvFile,
        ".parquet": _ParquetFile,
        ".arrow": _ArrowFile,
        ".feather": _ArrowFile,
    }
)
SUFFIXES: Final = tuple(_FORMS)


def table_file(name: str, file: BinaryIO) -> TableFile:
    """Return what writes a table in the format that a name tells.

    Raises:
        CallError: the name tells none.
        ExtraMissingError: what writes it is not installed.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in _FORMS:
        raise CallError(f"{name}: must end in {', '.join(SUFFIXES)}")
    if suffix != ".csv":
        try:
            import pyarrow  # noqa: F401, ICN001, PLC0415
        except ImportError as error:
            raise ExtraMissingError(name, "fleet") from error
    return _FORMS[suffix](file)


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
