"""Objects on their way from one process to another that was forked of it.

Arrays of results lie in memory that both share; whatever else there is goes through a pipe.
"""

import mmap
import pickle
from collections.abc import Sequence
from typing import Any, BinaryIO, Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes

_TRAY_SIZE: Final = 16 << 20
"""Bytes of a worker's shared memory: several times what comes of a batch, mostly."""
_ALIGNMENT: Final = 64
"""Bytes; numbers of any type may begin where a piece does."""


class NeighbourDied(Exception):  # noqa: N818 - an end, not an error
    """Who was to send something is no more."""


class Tray:
    """Memory that a worker shares with this process, for the arrays of one result at a time."""

    def __init__(self) -> None:
        # Of what nobody touches, the system sets nothing aside.
        self._memory = np.frombuffer(mmap.mmap(-1, _TRAY_SIZE), np.uint8)

    def lay(self, pieces: Sequence[memoryview]) -> list[int | None]:
        """Copy pieces into the memory; return the place of each, None where there is no room."""
        places: list[int | None] = []
        free = 0
        for piece in pieces:
            end = free + len(piece)
            if end > _TRAY_SIZE:
                places.append(None)
                continue
            self._memory[free:end] = np.frombuffer(piece, np.uint8)
            places.append(free)
            free = end + -end % _ALIGNMENT
        return places

    def piece(self, place: int, size: int) -> Bytes:
        """Return what lies at a place."""
        return self._memory[place : place + size]


def send(end: BinaryIO, thing: object, tray: Tray | None = None) -> None:
    """Send an object: its arrays as they lie, by the tray if there is one, the rest pickled."""
    arrays: list[pickle.PickleBuffer] = []
    rest = pickle.dumps(thing, protocol=5, buffer_callback=arrays.append)
    pieces = [array.raw() for array in arrays]
    places = tray.lay(pieces) if tray else [None] * len(pieces)
    pickle.dump((rest, [len(piece) for piece in pieces], places), end)
    end.writelines(piece for piece, place in zip(pieces, places, strict=True) if place is None)
    end.flush()


def receive(end: BinaryIO, tray: Tray | None = None, *, lent: bool = False) -> Any:  # noqa: ANN401 - it was pickled
    """Receive what `send` sent.

    Args:
        end: where it arrives.
        tray: where its arrays may lie.
        lent: whether to leave them there.

    Raises:
        NeighbourDied: it was not sent, or not to its end.
    """
    try:
        rest, sizes, places = pickle.load(end)  # noqa: S301 - a copy of this process made it
    except (EOFError, pickle.UnpicklingError) as error:
        raise NeighbourDied from error
    arrays: list[Bytes] = []
    for size, place in zip(sizes, places, strict=True):
        if tray is None or place is None:
            arrays.append(_read(end, size))
        else:
            array = tray.piece(place, size)
            arrays.append(array if lent else array.copy())
    return pickle.loads(rest, buffers=arrays)  # noqa: S301 - as above


def _read(end: BinaryIO, size: int) -> Bytes:
    array = np.empty(size, np.uint8)
    if end.readinto(array.data) < size:  # type: ignore[attr-defined]
        raise NeighbourDied
    return array
