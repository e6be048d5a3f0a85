"""What forked processes send each other: everything through pipes but the arrays of results."""

import mmap
import os
import pickle
import struct
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import Any, BinaryIO, Final

_SHARED_SIZE: Final = 16 << 20
"""Bytes; only those that were used once take memory."""
_SMALL: Final = 4096
"""Bytes up to which an array goes through the pipe."""
_LENGTH: Final = struct.Struct("<Q")

Pipe = tuple[BinaryIO, BinaryIO]
"""The ends of a pipe: to read from, and to write to."""


class PeerEndedError(Exception):
    """The process at the other end of a pipe ended before it sent all."""


def send(
    end: BinaryIO,
    thing: object,
    buffer_callback: Callable[[pickle.PickleBuffer], bool] | None = None,
) -> None:
    """Send a thing through a pipe.

    Args:
        end: to write to.
        thing: can be pickled.
        buffer_callback: takes the data of arrays, see `pickle.dump`; true: not this one.

    Raises:
        BrokenPipeError: the process at the other end ended.
    """
    # Protocol 5 writes large arrays to the pipe, and reads them from it, without copying them.
    pickle.dump(thing, end, protocol=5, buffer_callback=buffer_callback)
    end.flush()


def receive(end: BinaryIO, buffers: Iterable[bytearray] = ()) -> Any:  # noqa: ANN401 - it was pickled
    """Receive what `send` sent.

    Args:
        end: to read from.
        buffers: the data of arrays that did not come through the pipe, in their order.

    Raises:
        PeerEndedError: it was not sent, or only in part.
    """
    try:
        return pickle.load(end, buffers=buffers)  # noqa: S301 - a copy of this process made it
    except (EOFError, pickle.UnpicklingError) as error:
        raise PeerEndedError from error


class ResultChannel:
    """Carries the results of one worker to the first process, one at a time.

    A pipe holds 64 KB: what is larger makes both sides wait for each other many times. So arrays go
    through memory that both share.
    """

    def __init__(self, results: Pipe, taken: Pipe) -> None:
        """Set it up, before the worker is forked.

        Args:
            results: for what does not go through the shared memory.
            taken: tells the worker that the memory is free again.

        Raises:
            OSError: there is no such memory.
        """
        self._results_out, self._results_in = results
        self._taken_out, self._taken_in = taken
        self._shared = mmap.mmap(-1, _SHARED_SIZE)
        self._used = 0
        self._is_free = True

    @property
    def first_ends(self) -> tuple[BinaryIO, BinaryIO]:
        """The ends of pipes that the first process needs."""
        return self._results_out, self._taken_in

    @property
    def worker_ends(self) -> tuple[BinaryIO, BinaryIO]:
        """The ends of pipes that the worker needs."""
        return self._results_in, self._taken_out

    def send(self, result: object) -> None:
        """Send a result, as soon as the one before has been received.

        Raises:
            PeerEndedError: the first process ended.
            BrokenPipeError: likewise.
        """
        if not self._is_free and not self._taken_out.read(1):
            raise PeerEndedError
        self._is_free = False
        self._used = 0
        send(self._results_in, result, self._place)

    def receive(self) -> Any:  # noqa: ANN401 - it was pickled
        """Receive a result.

        Raises:
            PeerEndedError: it was not sent, or only in part.
        """
        result = receive(self._results_out, self._placed())
        # A worker that has sent its last result has ended, perhaps.
        with suppress(BrokenPipeError):
            os.write(self._taken_in.fileno(), b"\0")
        return result

    def _place(self, array: pickle.PickleBuffer) -> bool:
        """Copy an array into the shared memory, behind its length; true: the pipe takes it."""
        data = array.raw()
        start = self._used + _LENGTH.size
        end = start + data.nbytes
        if data.nbytes <= _SMALL or end > len(self._shared):
            return True
        _LENGTH.pack_into(self._shared, self._used, data.nbytes)
        self._shared[start:end] = data
        self._used = end
        return False

    def _placed(self) -> Iterator[bytearray]:
        """Yield copies of the arrays in the shared memory."""
        end = 0
        while True:
            start = end + _LENGTH.size
            end = start + _LENGTH.unpack_from(self._shared, end)[0]
            yield bytearray(memoryview(self._shared)[start:end])
