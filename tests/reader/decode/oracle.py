"""Definitions made up by hypothesis, messages of them, and rosbags' reading of these."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from rosbags.serde import SerdeError
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from dogbot_logtool.core.arrays import Flags
from dogbot_logtool.reader.decode.columns import Table, Texts
from dogbot_logtool.reader.decode.decode import decode
from dogbot_logtool.reader.decode.definition import parse_definition
from dogbot_logtool.reader.decode.message_layout import Layout, compile_layout

Wire = Literal["ros1", "cdr little-endian", "cdr big-endian"]
WIRES: Final[tuple[Wire, ...]] = ("ros1", "cdr little-endian", "cdr big-endian")
ROOT: Final = "demo/msg/Root"
NUMBERS: Final = {
    **{name: np.dtype(name) for name in ("bool", "float32", "float64")},
    **{f"{sign}int{bits}": np.dtype(f"{sign}int{bits}") for sign in ("", "u") for bits in (8, 16)},
    **{f"{sign}int{bits}": np.dtype(f"{sign}int{bits}") for sign in ("", "u") for bits in (32, 64)},
    "byte": np.dtype("int8"),
    "char": np.dtype("uint8"),
}
PADDING: Final = "uint8 structure_needs_at_least_one_member\n"
CLOCKS: Final = {
    1: {"Time": "uint32 sec\nuint32 nanosec\n", "Duration": "int32 sec\nint32 nanosec\n"},
    2: dict.fromkeys(("Time", "Duration"), "int32 sec\nuint32 nanosec\n"),
}
generated = settings(
    max_examples=30,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@dataclass(frozen=True)
class Definition:
    """A message type with all that it depends on."""

    text: str
    """As a recorder writes it."""
    ros: Literal[1, 2]

    def layout(self, wire: Wire, wanted: Sequence[str] | None = None) -> Layout:
        struct = parse_definition(ROOT, self.text, f"ros{self.ros}msg")
        return compile_layout(struct, "ros1" if wire == "ros1" else "cdr", wanted)

    @property
    def store(self) -> Typestore:
        return store_of(self.text, self.ros)

    def fields(self, name: str) -> Sequence[tuple[str, Any]]:
        # In ROS 1, an empty message takes no byte, whatever rosbags calls it.
        found = self.store.fielddefs[name][1]
        return (
            found if self.ros == 2 else [each for each in found if each[0] not in PADDING.split()]
        )


@lru_cache(maxsize=1)
def store_of(text: str, ros: Literal[1, 2]) -> Typestore:
    store = Typestore()
    types = dict(get_types_from_msg(text, ROOT))
    for name, lines in CLOCKS[ros].items():
        types |= get_types_from_msg(lines, f"builtin_interfaces/msg/{name}")
    store.register(types)
    return store


def define(ros: Literal[1, 2], root: str = "", **messages: str) -> Definition:
    """Build a definition from lines such as ``float64[3] x``, of the root and its dependencies."""
    sections = [root, *(f"MSG: demo/{name}\n{lines}" for name, lines in messages.items())]
    return Definition(f"\n{'=' * 80}\n".join(sections), ros)


@st.composite
def definitions(draw: st.DrawFn, ros: Literal[1, 2]) -> Definition:
    """Several levels of messages of every kind of field; the last one is the root."""
    messages = {"Empty": "" if ros == 1 else PADDING}
    names = ["Empty", *(("time", "duration") if ros == 1 else ())]
    names += [f"builtin_interfaces/{name}" for name in CLOCKS[ros] if ros == 2]
    kinds = st.sampled_from([*NUMBERS, "string", "string"])
    arrays = st.sampled_from(["", "", "[]", "[]", "[1]", "[3]"])
    empty = {"Empty"} if ros == 1 else set()
    below = draw(st.integers(0, 3))
    for level in range(below + 1):
        lines, name = "", f"Level{level}"
        holds_nothing = True
        for index in range(draw(st.integers(2 if level else 0, 6))):
            # Two in three are references, if there is more than the simple ones to refer to.
            nested = draw(st.integers(0, 2)) < (2 if level else 1)
            kind = draw(st.sampled_from(names[-4:])) if nested else draw(kinds)
            # See the tests of arrays of empty messages.
            array = "" if kind in empty else draw(arrays)
            holds_nothing &= kind in empty
            lines += f"{kind}{array} f{index}\n"
        messages[name] = lines if lines or ros == 1 else PADDING
        empty |= {name} if holds_nothing and messages[name] != PADDING else set()
        names.append(name)
    definition = define(ros, messages.pop(names[-1]), **messages)
    if ros == 1 or not draw(st.booleans()):
        return definition
    rule = "=" * 80
    recorded = (f"\n{rule}\nMSG: builtin_interfaces/{n}\n{each}" for n, each in CLOCKS[2].items())
    return Definition(definition.text + "".join(recorded), ros)


def ros_of(wire: Wire) -> Literal[1, 2]:
    return 1 if wire == "ros1" else 2


def dotted_paths(definition: Definition, name: str = ROOT, prefix: str = "") -> Iterator[str]:
    for field, (kind, detail) in definition.fields(name):
        yield prefix + field
        inner = detail if kind.name == "NAME" else detail[0][1]
        if kind.name == "NAME" or (kind.name != "BASE" and detail[0][0].name == "NAME"):
            yield from dotted_paths(definition, inner, f"{prefix}{field}.")


class Author:
    """Writes random messages of a definition; rosbags serialises them, and reads them."""

    def __init__(self, definition: Definition, wire: Wire, seed: int = 0) -> None:
        self._definition = definition
        self._store = definition.store
        self._wire = wire
        self._random = np.random.default_rng(seed)
        self.refusal = ""
        """Why the last message was refused."""

    def write(self, count: int) -> list[bytes]:
        messages = [self._value("NAME", ROOT) for _ in range(count)]
        if self._wire == "ros1":
            return [bytes(self._store.serialize_ros1(each, ROOT)) for each in messages]
        little = self._wire == "cdr little-endian"
        serialise = self._store.serialize_cdr
        return [bytes(serialise(each, ROOT, little_endian=little)) for each in messages]

    def read(self, data: bytes) -> Any:
        """Return a message as rosbags reads it; None: it is refused."""
        ros1 = self._wire == "ros1"
        read = self._store.deserialize_ros1 if ros1 else self._store.deserialize_cdr
        try:
            return read(data, ROOT)
        except SerdeError as error:
            self.refusal = "not UTF-8" if "codec can't decode" in str(error) else str(error)
            return None

    @property
    def is_excused(self) -> bool:
        """Whether the last refusal is for something that the decoder knowingly accepts."""
        empty = "Invalid string length 0 ", "Invalid sequence length "
        return self.refusal == "not UTF-8" or (
            self._wire != "ros1" and self.refusal.startswith(empty)
        )

    def _value(self, kind: str, detail: Any) -> Any:
        if kind == "NAME":
            fields = self._definition.fields(detail)
            values = {name: self._value(each[0].name, each[1]) for name, each in fields}
            return self._store.types[detail](**values)
        if kind == "BASE":
            return self._number(detail[0]).item() if detail[0] != "string" else self._text()
        (inner, of_inner), length = detail
        count = int(self._random.integers(0, 5)) if kind == "SEQUENCE" else length
        if inner.name == "BASE" and of_inner[0] != "string":
            numbers = [self._number(of_inner[0]) for _ in range(count)]
            return np.array(numbers, NUMBERS[dtype_name(of_inner[0])])
        return [self._value(inner.name, of_inner) for _ in range(count)]

    def _text(self) -> str:
        letters = "ab \0é€😀/_" if self._random.random() < 0.1 else "ab \0/_"
        return "".join(self._random.choice(list(letters), self._random.integers(0, 9)))

    def _number(self, kind: str) -> Any:
        dtype = NUMBERS[dtype_name(kind)]
        if kind == "bool":
            return dtype.type(self._random.integers(0, 2))
        if kind.startswith("float") and self._random.random() < 0.5:
            special = [0.0, -0.0, 1.5, np.inf, -np.inf, np.nan, 5e-324, 1e-40]
            return dtype.type(self._random.choice(special))
        return np.frombuffer(self._random.bytes(dtype.itemsize), dtype)[0]


def dtype_name(kind: str) -> str:
    return "byte" if kind == "octet" else kind


def assert_same(
    definition: Definition, table: Table, messages: Sequence[Any], name: str = ROOT, to: str = ""
) -> None:
    """Compare columns with messages that rosbags has read, field by field."""
    assert table.rows == len(messages)
    for field, (kind, detail) in definition.fields(name):
        values = [getattr(message, field) for message in messages]
        assert_column(definition, table, to + field, kind.name, detail, values)


def assert_column(
    definition: Definition, table: Table, path: str, kind: str, detail: Any, values: list[Any]
) -> None:
    if kind == "NAME":
        assert_same(definition, table, values, detail, f"{path}.")
    elif kind == "BASE" and detail[0] == "string":
        assert [table.texts(path).text(row) for row in range(table.rows)] == values
    elif kind == "BASE":
        assert_numbers(table.numbers(path), values, detail[0], (table.rows,))
    elif kind == "ARRAY" and detail[0][0].name == "BASE" and detail[0][1][0] != "string":
        (_, (element, _)), length = detail
        assert_numbers(table.numbers(path), values, element, (table.rows, length))
    else:
        nested, (inner, of_inner) = table.nested(path), detail[0]
        elements = [iter(each) for each in values]
        found = [next(elements[row]) for row in nested.parent.tolist()]
        assert len(found) == sum(map(len, values))
        if inner.name == "NAME":
            assert_same(definition, nested.table, found, of_inner)
        else:
            assert_column(definition, nested.table, "value", "BASE", of_inner, found)


def assert_numbers(found: Any, values: Any, kind: str, shape: tuple[int, ...]) -> None:
    """Compare numbers: NaN equals itself, zeros have signs."""
    expected = np.array(values, NUMBERS[dtype_name(kind)]).reshape(shape)
    assert found.shape == shape
    if kind in {"bool", "byte", "octet"}:  # rosbags reads bytes signed, see the test of ROS 1's
        to = np.bool_ if kind == "bool" else np.uint8
        found, expected = found.astype(to), expected.astype(to)
    if expected.dtype.kind == "f":
        zero = found == 0
        np.testing.assert_array_equal(np.signbit(found)[zero], np.signbit(expected)[zero])
    np.testing.assert_array_equal(found, expected)


def texts_of(values: Sequence[str]) -> Texts:
    """Return a column of texts."""
    encoded = [value.encode() for value in values]
    length = np.array([len(data) for data in encoded], np.int64)
    buffer = np.frombuffer(b"".join(encoded) + b"\0" * 8, np.uint8)
    return Texts(buffer, np.cumsum(length) - length, length)


class Decoded(NamedTuple):
    """What `decode` returns."""

    table: Table
    sound: Flags


def decode_messages(layout: Layout, messages: Sequence[bytes], seed: int = 0) -> Decoded:
    """Decode messages that stand in a buffer in any order, with rubbish between them."""
    random = np.random.default_rng(seed)
    start = np.zeros(len(messages), np.int64)
    buffer = bytearray()
    for row in random.permutation(len(messages)):
        buffer += b"\xff" * int(random.integers(0, 9))
        start[row] = len(buffer)
        buffer += messages[row]
    return decode_at(layout, bytes(buffer), start, [len(message) for message in messages])


def decode_alone(layout: Layout, message: bytes) -> Decoded:
    """Decode a message that is all there is in the buffer."""
    return decode_at(layout, message, np.zeros(1, np.int64), [len(message)])


def decode_at(layout: Layout, buffer: bytes, start: Any, length: Sequence[int]) -> Decoded:
    end = start + np.array(length, np.int64)
    return Decoded(*decode(layout, np.frombuffer(buffer, np.uint8), start, end))
