"""Tables: numpy arrays with units in their names."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from numpy.typing import NDArray

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.report.tables import arrow_table


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Table:
    """Columns of one length; `table["duty_factor"]` is one of them.

    DuckDB, Polars and pandas take a table as it is, through the Arrow PyCapsule interface.
    """

    columns: Mapping[str, NDArray[Any]]
    """(n,) each, the unit at the end of the name; NaN (or None in a column of objects) where not
    known. They cannot be written to."""

    def __post_init__(self) -> None:
        for column in self.columns.values():
            column.flags.writeable = False

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a column.

        Raises:
            KeyError: the table has no such column; the message lists those it has.
        """
        try:
            return self.columns[name]
        except KeyError:
            raise KeyError(f"{name!r}: the columns are {', '.join(self.columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self.columns)}>"

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is not among our packages
        """Return a `pandas.DataFrame`.

        Raises:
            LogtoolError: pandas is not installed.
        """
        return _package("pandas").DataFrame(self._copies())

    def to_polars(self) -> Any:  # noqa: ANN401 - polars is not among our packages
        """Return a `polars.DataFrame`; NaN stays NaN.

        Raises:
            LogtoolError: polars is not installed.
        """
        return _package("polars").DataFrame(self._copies())

    def to_arrow(self) -> Any:  # noqa: ANN401 - pyarrow has no types
        """Return a `pyarrow.Table`; NaN is null there, as in the dataset of `export --dataset`.

        Raises:
            LogtoolError: pyarrow is not installed.
        """
        _package("pyarrow")
        return arrow_table(self.columns)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Export the table; see the Arrow PyCapsule interface."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def _copies(self) -> dict[str, NDArray[Any]]:
        """Return columns that may be written to."""
        return {name: column.copy() for name, column in self.columns.items()}


def _package(name: str) -> Any:  # noqa: ANN401 - any module
    """Import a package that may not be installed.

    Raises:
        LogtoolError: it is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise LogtoolError(
            f"{name} is not installed; 'pip install {name}' into the environment of this Python "
            "installs it"
        ) from error
