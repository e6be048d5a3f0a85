"""Texts from a log made harmless for terminals, reports and shells; streams for any text.

Standard streams never fail to be written to here, and on them any text is printable.
"""

import contextlib
import errno
import io
import os
import shlex
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO, Final, TextIO, cast

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

MOST: Final = 10


def printable(text: str) -> str:
    """Return the text with control characters, line breaks included, as visible escapes."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def printable_lines(text: str) -> str:
    """Return the text with control characters as visible escapes; line breaks and tabs stay."""
    lines = (map(printable, line.split("\t")) for line in text.split("\n"))
    return "\n".join(map("\t".join, lines))


def shell_quoted(word: str) -> str:
    """Return a word as a shell takes it; one with control characters is only shown."""
    return printable(shlex.quote(word))


def shell_joined(words: Iterable[str]) -> str:
    """Return a command that can be pasted into a shell; see `shell_quoted`."""
    return " ".join(map(shell_quoted, words))


def listed(names: Sequence[str], most: int = MOST) -> str:
    """Return ``a, b, c and 4 more``."""
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


# --- Streams --------------------------------------------------------------------------------------


class LastingFile(io.RawIOBase):
    """The file of a stream; what cannot be written is dropped, and all that follows."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._is_lost = False
        self.error: OSError | None = None
        """Why bytes were dropped; None if that is only because their reader wanted no more."""

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write bytes, or drop them if they cannot be written."""
        with memoryview(data) as view:
            size = view.nbytes
        if self._is_lost:
            return size
        try:
            # A file that would have to wait returns nothing.
            if (written := cast("int | None", self._file.write(data))) is not None:
                return written
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        except OSError as error:
            self._is_lost = True
            self.error = None if isinstance(error, BrokenPipeError) else error
        return size

    def writable(self) -> bool:
        """Return True, always."""
        return True

    def isatty(self) -> bool:
        """Tell whether it is a terminal."""
        return self._file.isatty()


class PrintableStream(io.TextIOWrapper):
    """A stream for any text; `styled` is the same stream for text whose colours are meant."""

    def __init__(self, buffer: BinaryIO, **look: Any) -> None:  # noqa: ANN401 - as `TextIOWrapper`
        super().__init__(buffer, **look)
        self.styled = io.TextIOWrapper(buffer, **look)

    def write(self, text: str, /) -> int:
        """Write a text with control characters as visible escapes; line breaks and tabs stay."""
        super().write(printable_lines(text))
        return len(text)

    @property
    def encoding(self) -> str:  # type: ignore[override] # typeshed has a variable
        """A name by which click takes the stream as it is: it writes around those in ASCII."""
        return "utf-8"


def styled(stream: TextIO) -> TextIO:
    """Return the stream that takes colours, too, for text that is printable already."""
    return cast("TextIO", getattr(stream, "styled", stream))


@contextlib.contextmanager
def safe_streams() -> Iterator[LastingFile]:
    """Make `sys.stdout` and `sys.stderr` safe to write to.

    Yields:
        the file of stdout, which knows after a flush whether all of it could be written.
    """
    _fill_gaps()
    before = sys.stdout, sys.stderr
    streams: list[TextIO] = [
        stream or open(number, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - stays open
        for number, stream in enumerate(before, 1)
    ]
    # Streams in memory, such as those of a notebook, have no buffer, and stay as they are.
    buffers = [getattr(each, "buffer", io.BytesIO()) for each in streams]
    # Without their buffers, which would try to write once more at exit what could not be written.
    out, err = (LastingFile(getattr(each, "raw", each)) for each in buffers)
    sys.stdout, sys.stderr = map(_printable, (out, err), streams)
    try:
        yield out
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        sys.stdout, sys.stderr = before


def _printable(file: LastingFile, stream: TextIO) -> TextIO:
    """Return a stream to a file that is like another one."""
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    # Files and pipes get the same bytes on all systems.
    is_own = file.isatty() or "PYTHONIOENCODING" in os.environ
    return PrintableStream(
        cast("BinaryIO", io.BufferedWriter(file)),
        encoding=stream.encoding if is_own else "utf-8",
        # Characters that the encoding of a terminal lacks are escaped.
        errors="backslashreplace",
        newline=None if is_own else "\n",
        line_buffering=bool(stream.line_buffering),
        write_through=True,
    )


def _fill_gaps() -> None:
    """Open whichever of the file descriptors 0 to 2 is closed, so that no other file gets it.

    They are opened for reading: writing fails as it does for what is closed.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # It gets the lowest number that is free, which is this one.
            os.set_inheritable(os.open(os.devnull, os.O_RDONLY), True)  # noqa: FBT003 - takes no keyword
