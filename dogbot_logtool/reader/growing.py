"""Columns that grow part by part: in memory, or in a file without a name where they are large."""

from dataclasses import fields
from io import BytesIO
from typing import IO, Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.errors import LogtoolError

LARGEST_IN_MEMORY: Final = 128 << 20
"""Bytes from which a column lies in a file that is mapped into memory: those of four feet then
take some 2 GB."""


class GrowingColumns:
    """The columns of a record, or a single one, which grow by those of others of its type."""

    def __init__(self, first: Any) -> None:  # noqa: ANN401
        """Begin with the rows of a record, or with a column."""
        self._type = type(first)
        self._columns = [_Column(each) for each in _columns_of(first)]
        self.add(first)

    def add(self, part: Any) -> None:  # noqa: ANN401
        """Append rows.

        Raises:
            LogtoolError: the file cannot be written.
        """
        for column, each in zip(self._columns, _columns_of(part), strict=True):
            column.add(each)

    def finish(self) -> Any:  # noqa: ANN401
        """Return all rows."""
        found, self._columns = [column.finish() for column in self._columns], []
        return found[0] if self._type is np.ndarray else self._type(*found)


def _columns_of(part: Any) -> list[NDArray[Any]]:  # noqa: ANN401
    if isinstance(part, np.ndarray):
        return [part]
    return [getattr(part, field.name) for field in fields(part)]


class _Column:
    """The bytes of a column."""

    def __init__(self, like: NDArray[Any]) -> None:
        self._shape, self._dtype = (-1, *like.shape[1:]), like.dtype
        self._bytes: IO[bytes] = BytesIO()

    def add(self, values: NDArray[Any]) -> None:
        try:
            if isinstance(self._bytes, BytesIO) and self._bytes.tell() > LARGEST_IN_MEMORY:
                self._bytes = _in_a_file(self._bytes)
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
        if isinstance(self._bytes, BytesIO):
            return np.frombuffer(self._bytes.getbuffer(), self._dtype).reshape(self._shape)
        with self._bytes:
            return np.memmap(self._bytes, self._dtype, "r+").reshape(self._shape)


def _in_a_file(memory: BytesIO) -> IO[bytes]:
    """Return a file without a name, of which nothing stays, that holds some bytes."""
    import tempfile  # noqa: PLC0415 - takes long, and few logs are so large

    file = tempfile.TemporaryFile(prefix="dogbot_logtool_")  # noqa: SIM115
    file.write(memory.getbuffer())
    return file
