"""Standard output and standard error that are safe to write to.

Text cannot upset a terminal: control characters become visible escapes. A reader that has gone, or
a device that is full, does not change what the program does: it goes on, the text is dropped, and
`main` finds out at the end whether results were lost.
"""

import contextlib
import io
import os
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, BinaryIO, TextIO, cast

from dogbot_logtool.io.printable import printable_lines

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class LastingStream(io.TextIOBase):
    """A text stream that never fails to be written to."""

    def __init__(self, stream: TextIO) -> None:
        if isinstance(stream, io.TextIOWrapper) and isinstance(stream.buffer, io.RawIOBase):
            # With PYTHONUNBUFFERED, text of which only a part could be written would be lost.
            stream = open(stream.fileno(), "w", 1, stream.encoding, closefd=False)  # noqa: SIM115 - stays open
        self._stream = stream
        self._is_lost = False
        self.error: OSError | None = None
        """Why text was dropped; None if that is only because its reader wanted no more."""
        if isinstance(stream, io.TextIOWrapper):
            # Characters that the encoding of a terminal lacks are escaped.
            stream.reconfigure(errors="backslashreplace")
            if not stream.isatty() and "PYTHONIOENCODING" not in os.environ:
                # Files and pipes get the same bytes on all systems.
                stream.reconfigure(encoding="utf-8", newline="\n")

    def write(self, text: str, /) -> int:
        """Write a text, or drop it if it cannot be written."""
        self._attempt(lambda: self._stream.write(text))
        return len(text)

    def flush(self) -> None:
        """Write what is still buffered."""
        self._attempt(self._stream.flush)

    def _attempt(self, action: Callable[[], object]) -> None:
        if self._is_lost:
            return
        try:
            action()
        except OSError as error:
            self._is_lost = True
            self.error = None if isinstance(error, BrokenPipeError) else error
            self._discard()

    def _discard(self) -> None:
        """Drop what is still buffered: the interpreter would fail to write it once more at exit."""
        with contextlib.suppress(OSError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)
            self._stream.flush()

    def close(self) -> None:
        """Leave it open: the interpreter closes its streams itself."""

    def writable(self) -> bool:
        """Return True, always."""
        return True

    def isatty(self) -> bool:
        """Tell whether it is a terminal."""
        return self._stream.isatty()

    def fileno(self) -> int:
        """Return the file descriptor."""
        return self._stream.fileno()

    @property
    def encoding(self) -> str:  # type: ignore[override] # typeshed has a variable
        """Encoding of the text."""
        return self._stream.encoding


class PrintableStream(LastingStream):
    """A stream for any text; `styled` is the same stream for text whose colours are meant."""

    def __init__(self, styled: LastingStream) -> None:
        super().__init__(cast("TextIO", styled))
        self.styled = styled

    def write(self, text: str, /) -> int:
        """Write a text with control characters as visible escapes; line breaks and tabs stay."""
        super().write(printable_lines(text))
        return len(text)

    @property
    def buffer(self) -> BinaryIO:
        """The same stream for UTF-8; click writes completion scripts to it."""
        return cast("BinaryIO", _Utf8Stream(self))


class _Utf8Stream(io.RawIOBase):
    """A text stream that is written in UTF-8."""

    def __init__(self, text: PrintableStream) -> None:
        self._text = text

    def writable(self) -> bool:
        """Return True, always."""
        return True

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write whole characters."""
        encoded = bytes(data)
        self._text.write(encoded.decode("utf-8", "backslashreplace"))
        return len(encoded)

    def flush(self) -> None:
        """See `LastingStream.flush`."""
        self._text.flush()


def styled(stream: TextIO) -> TextIO:
    """Return the stream that takes colours, too, for text that is printable already."""
    return cast("TextIO", getattr(stream, "styled", stream))


@contextlib.contextmanager
def safe_streams() -> Iterator[LastingStream]:
    """Make `sys.stdout` and `sys.stderr` safe to write to.

    Yields:
        stdout, which knows after a flush whether all of it could be written.
    """
    _fill_gaps()
    before = sys.stdout, sys.stderr
    out, err = (
        LastingStream(stream or open(number, "w", encoding="utf-8", closefd=False))  # noqa: SIM115 - stays open
        for number, stream in enumerate(before, 1)
    )
    sys.stdout, sys.stderr = (cast("TextIO", PrintableStream(each)) for each in (out, err))
    try:
        yield out
    finally:
        sys.stdout, sys.stderr = before
        out.flush()
        err.flush()


def _fill_gaps() -> None:
    """Open whichever of the file descriptors 0 to 2 is closed, so that no other file gets it.

    They are opened for reading: writing fails as it does for what is closed.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            nothing = os.open(os.devnull, os.O_RDONLY)
            if nothing != number:
                os.dup2(nothing, number)
                os.close(nothing)
            os.set_inheritable(number, True)  # noqa: FBT003 - takes no keyword
