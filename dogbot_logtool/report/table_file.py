"""Tables as files and in memory: CSV, Parquet and Arrow."""

import csv
import io
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.errors import CallError, ExtraMissingError
from dogbot_logtool.io.printable import printable

SUFFIXES: Final = (".csv", ".parquet", ".arrow", ".feather")
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
