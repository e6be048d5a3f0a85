"""How the fields of a message type lie in its bytes, compiled from its definition.

A layout is a short list of steps. Neighbouring fields of fixed width become one `Run` with
static offsets; strings and arrays are steps of their own. ROS 1 serialisation and CDR differ only
in alignment (CDR aligns every number to its own width, counted from the end of the
encapsulation header) and in the strings' terminator.
"""

from collections.abc import Collection, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Serialisation,
    Struct,
    Text,
    VariableArray,
    smallest_size,
)

ELEMENT: Final = "value"
"""Name of the column that holds the elements of an array of numbers or strings."""
_CDR_ORIGIN_ALIGNMENT: Final = 8


class Run(NamedTuple):
    """Fields of fixed width, one after the other."""

    alignment: int
    size: int
    first: int = 0
    """Offset of the first wanted number."""
    wanted: np.dtype[np.void] | None = None
    """The wanted numbers, little-endian, which are fetched together, with a field a path; None:
    none are."""


class TextStep(NamedTuple):
    """A string."""

    path: str
    wanted: bool
    alignment: int


class ArrayStep(NamedTuple):
    """An array of anything that is not a fixed array of numbers."""

    path: str
    wanted: bool
    alignment: int
    """Alignment of the count."""
    length: int | None
    """Static number of elements; None: a 32-bit count is recorded."""
    smallest_element: int
    """Fewest bytes an element can take."""
    element: tuple["Step", ...]


Step = Run | TextStep | ArrayStep


class Layout(NamedTuple):
    """The compiled layout of one message type in one serialisation."""

    serialisation: Serialisation
    steps: tuple[Step, ...]


def compile_layout(
    definition: FieldType, serialisation: Serialisation, wanted: Collection[str] | None
) -> Layout:
    """Compile a definition.

    Args:
        definition: the type's tree.
        serialisation: how its messages are written.
        wanted: dotted paths of the fields to decode; a path covers all below it. None: all.
            Other fields are stepped over, but still checked.
    """
    compiler = _Compiler(serialisation, wanted, modulus=_CDR_ORIGIN_ALIGNMENT)
    compiler.add("", definition)
    return Layout(serialisation, compiler.finish())


class _Compiler:
    """Emits steps field by field; `_modulus` is the alignment known at the run's start."""

    def __init__(
        self, serialisation: Serialisation, wanted: Collection[str] | None, modulus: int | None
    ) -> None:
        self._serialisation: Serialisation = serialisation
        self._cdr = serialisation == "cdr"
        self._wanted = wanted
        self._steps: list[Step] = []
        self._leaves: list[tuple[str, int, str]] = []
        """Path, offset and format of each wanted number, or fixed array of numbers."""
        self._size = 0
        self._alignment = 1
        self._modulus = modulus

    def add(self, path: str, field_type: FieldType) -> None:
        match field_type:
            case Primitive(dtype):
                self._number(path or ELEMENT, dtype, None)
            case FixedArray(Primitive(dtype), length):
                self._number(path, dtype, length)
            case Struct(_, fields):
                for name, inner in fields:
                    self.add(f"{path}.{name}" if path else name, inner)
            case Text():
                alignment = self._close_run_aligned_to(4)
                name = path or ELEMENT
                self._steps.append(TextStep(name, self._is_wanted(name), alignment))
            case FixedArray(element, length):
                self._close_run()
                self._array(path, element, 1, length)
            case VariableArray(element):
                self._array(path, element, self._close_run_aligned_to(4), None)

    def finish(self) -> tuple[Step, ...]:
        self._close_run()
        return tuple(self._steps)

    def _number(self, path: str, dtype: str, length: int | None) -> None:
        size = int(dtype[1:])
        if self._cdr:
            if self._modulus is None or size > self._modulus:
                self._close_run()
                self._alignment = self._modulus = size
            self._size += -self._size % size
        if self._is_wanted(path):
            shape = "" if length is None else f"({length},)"
            self._leaves.append((path, self._size, f"{shape}<{dtype}"))
        self._size += size * (1 if length is None else length)

    def _array(self, path: str, element: FieldType, alignment: int, length: int | None) -> None:
        inside = self._wanted_inside(path)
        compiler = _Compiler(self._serialisation, inside, modulus=None)
        compiler.add("", element)
        self._steps.append(
            ArrayStep(
                path=path,
                wanted=self._is_wanted(path) or bool(inside),
                alignment=alignment,
                length=length,
                smallest_element=smallest_size(element),
                element=compiler.finish(),
            )
        )

    def _close_run(self) -> None:
        if self._size:
            self._steps.append(Run(self._alignment, self._size, *_fetched(self._leaves)))
        self._leaves, self._size, self._alignment, self._modulus = [], 0, 1, None

    def _close_run_aligned_to(self, alignment: int) -> int:
        """Close the run before a field; return the alignment that is left to do at run time."""
        if not self._cdr:
            self._close_run()
            return 1
        static = self._modulus is not None and self._modulus >= alignment
        if static:
            self._size += -self._size % alignment
        self._close_run()
        return 1 if static else alignment

    def _is_wanted(self, path: str) -> bool:
        if self._wanted is None:
            return True
        return any(path == want or path.startswith(f"{want}.") for want in self._wanted)

    def _wanted_inside(self, path: str) -> Collection[str] | None:
        if self._wanted is None or self._is_wanted(path):
            return None
        inside = f"{path}."
        return [want.removeprefix(inside) for want in self._wanted if want.startswith(inside)]


def _fetched(leaves: Sequence[tuple[str, int, str]]) -> tuple[int, np.dtype[np.void] | None]:
    """Return the offset of the first of some numbers, and the dtype of all."""
    if not leaves:
        return 0, None
    paths, offsets, formats = zip(*leaves, strict=True)
    first, end = offsets[0], offsets[-1] + np.dtype(formats[-1]).itemsize
    dtype = np.dtype(
        {
            "names": [*paths],
            "formats": [*formats],
            "offsets": [offset - first for offset in offsets],
            "itemsize": end - first,
        }
    )
    return first, dtype
