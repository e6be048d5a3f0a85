"""Columns that grow part by part: in memory, or in a file without a name where they are large."""

import tempfile
from dataclasses import fields
from typing import IO, Any, Final, Generic

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import AnyColumns
from dogbot_logtool.errors import LogtoolError

LARGEST_IN_MEMORY: Final = 2 << 30
"""Bytes from which columns lie in a file that is mapped into memory."""
_FIRST_BYTES: Final = 64 << 10
_BLOCK_BYTES: Final = 4 << 20
"""Of a block: large enough for the system to take it back when it is freed."""


class GrowingColumns(Generic[AnyColumns]):
    """The columns of a record, which grow by those of other records of its type.

    Args:
        on_disk: whether they lie in a file.
    """

    def __init__(self, *, on_disk: bool = False) -> None:
        self._on_disk = on_disk
        self._type: type[AnyColumns] | None = None
        self._columns: list[_Blocks | _File] = []

    def add(self, part: AnyColumns) -> None:
        """Append the rows of a record."""
        names = [field.name for field in fields(part)]
        if self._type is None:
            self._type = type(part)
            self._columns = [_File() if self._on_disk else _Blocks() for _ in names]
        for name, column in zip(names, self._columns, strict=True):
            column.add(getattr(part, name))

    def finish(self, nothing: AnyColumns) -> AnyColumns:
        """Return all rows, or a record without any if none was ever added."""
        if self._type is None:
            return nothing
        found = self._type(*(column.finish() for column in self._columns))
        self._columns = []
        return found


class _Blocks:
    """A column in memory: copied into blocks, so that small parts can be freed at once."""

    def __init__(self) -> None:
        self._blocks: list[NDArray[Any]] = []
        self._filled = 0

    def add(self, values: NDArray[Any]) -> None:
        """Append rows."""
        if not self._blocks:
            self._begin(values)
        while True:
            block = self._blocks[-1]
            count = min(len(values), len(block) - self._filled)
            block[self._filled : self._filled + count] = values[:count]
            self._filled += count
            values = values[count:]
            if not len(values):
                return
            self._begin(values)

    def finish(self) -> NDArray[Any]:
        """Return all rows."""
        self._blocks[-1] = self._blocks[-1][: self._filled]
        whole = np.concatenate(self._blocks)
        self._blocks.clear()
        return whole

    def _begin(self, values: NDArray[Any]) -> None:
        row_bytes = values.itemsize * int(np.prod(values.shape[1:], dtype=np.int64))
        size = min(_FIRST_BYTES << len(self._blocks), _BLOCK_BYTES)
        rows = max(size // row_bytes, 1)
        self._blocks.append(np.empty((rows, *values.shape[1:]), values.dtype))
        self._filled = 0


class _File:
    """A column in a file that has no name, so that nothing of it stays."""

    def __init__(self) -> None:
        self._file: IO[bytes] = tempfile.TemporaryFile(prefix="dogbot_logtool_")  # noqa: SIM115 - mapped as long as the column is used
        self._rows = 0
        self._like: NDArray[Any] = np.empty(0)

    def add(self, values: NDArray[Any]) -> None:
        """Append rows.

        Raises:
            LogtoolError: the file cannot be written.
        """
        self._like = values[:0]
        self._rows += len(values)
        try:
            self._file.write(np.ascontiguousarray(values).data)
            self._file.flush()
        except OSError as error:
            folder = tempfile.gettempdir()
            raise LogtoolError(
                f"the columns of this log are too large for memory, and {folder} cannot hold them: "
                f"{error.strerror}; set TMPDIR to a folder on a larger disk"
            ) from error

    def finish(self) -> NDArray[Any]:
        """Return all rows, mapped into memory."""
        shape = (self._rows, *self._like.shape[1:])
        with self._file:
            if not self._rows:
                return np.empty(shape, self._like.dtype)
            return np.memmap(self._file, self._like.dtype, "r+", shape=shape)
