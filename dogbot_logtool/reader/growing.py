"""Columns that grow part by part: in memory, or in a file without a name where they are large."""

from dataclasses import fields
from io import BytesIO
from typing import IO, Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.errors import LogtoolError

LARGEST_IN_MEMORY: Final = 2 << 30
"""Bytes from which columns lie in a file that is mapped into memory."""


class GrowingColumns:
    """The columns of a record, or a single one, which grow by those of others of its type."""

    def __init__(self, first: Any, *, on_disk: bool = False) -> None:  # noqa: ANN401
        """Begin with the rows of a record, or with a column.

        Args:
            first: as those that are added.
            on_disk: whether they lie in a file.
        """
        self._type = type(first)
        self._columns = [_Column(each, on_disk=on_disk) for each in _columns_of(first)]
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
