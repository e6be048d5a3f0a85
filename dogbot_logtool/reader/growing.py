"""Columns that grow part by part: in memory, or in a file without a name where they are large."""

from dataclasses import fields
from io import BytesIO
from typing import IO, Any, Final, Generic

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import AnyColumns
from dogbot_logtool.errors import LogtoolError

LARGEST_IN_MEMORY: Final = 2 << 30
"""Bytes from which columns lie in a file that is mapped into memory."""


class GrowingColumns(Generic[AnyColumns]):
    """The columns of a record, which grow by those of other records of its type.

    Args:
        on_disk: whether they lie in a file.
    """

    def __init__(self, *, on_disk: bool = False) -> None:
        self._on_disk = on_disk
        self._type: type[AnyColumns] | None = None
        self._columns: list[_Column] = []

    def add(self, part: AnyColumns) -> None:
        """Append the rows of a record.

        Raises:
            LogtoolError: the file cannot be written.
        """
        values: list[NDArray[Any]] = [getattr(part, field.name) for field in fields(part)]
        if self._type is None:
            self._type = type(part)
            self._columns = [_Column(each, on_disk=self._on_disk) for each in values]
        for column, each in zip(self._columns, values, strict=True):
            column.add(each)

    def finish(self, nothing: AnyColumns) -> AnyColumns:
        """Return all rows, or a record without any if none was ever added."""
        if self._type is None:
            return nothing
        found = self._type(*(column.finish() for column in self._columns))
        self._columns = []
        return found


class _Column:
    """The bytes of a column."""

    def __init__(self, like: NDArray[Any], *, on_disk: bool) -> None:
        self._nothing = np.empty((0, *like.shape[1:]), like.dtype)
        self._bytes: IO[bytes] = BytesIO()
        if on_disk:
            import tempfile  # noqa: PLC0415 - takes long, and few logs are so large

            # Without a name, so that nothing of it stays.
            self._bytes = tempfile.TemporaryFile(prefix="dogbot_logtool_")  # noqa: SIM115

    def add(self, values: NDArray[Any]) -> None:
        try:
            self._bytes.write(np.ascontiguousarray(values).data)
            self._bytes.flush()
        except OSError as error:
            import tempfile  # noqa: PLC0415

            folder = tempfile.gettempdir()
            raise LogtoolError(
                f"the columns of this log are too large for memory, and {folder} cannot hold them: "
                f"{error.strerror}; set TMPDIR to a folder on a larger disk"
            ) from error

    def finish(self) -> NDArray[Any]:
        shape, dtype = (-1, *self._nothing.shape[1:]), self._nothing.dtype
        if isinstance(self._bytes, BytesIO):
            return np.frombuffer(self._bytes.getbuffer(), dtype).reshape(shape)
        with self._bytes:
            if not self._bytes.tell():
                return self._nothing
            return np.memmap(self._bytes, dtype, "r+").reshape(shape)
